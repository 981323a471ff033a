#include "data/body/skinning.h"

namespace cloth {

Points skin_points(const Points& rest, const SkinWeights& weights,
                   const std::vector<SkinMatrix>& matrices) {
    Points posed(rest.rows(), 3);
    for (int i = 0; i < weights.vertex_count(); ++i) {
        SkinMatrix blend = SkinMatrix::Zero();
        for (int k = weights.begin[i]; k < weights.begin[i + 1]; ++k)
            blend += weights.values[k] * matrices[weights.joints[k]];
        posed.row(i) = (blend.leftCols<3>() * rest.row(i).transpose() + blend.col(3)).transpose();
    }
    return posed;
}

}  // namespace cloth
