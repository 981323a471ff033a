#include "collision/geometry/fcl_hierarchy.h"

#include "collision/geometry/fcl_model.h"

namespace cloth {

std::vector<BinaryNode> build_fcl_hierarchy(const Points& vertices, const Faces& faces) {
    if (faces.rows() == 0) return {};
    Points finite = vertices;
    for (Eigen::Index i = 0; i < finite.rows(); ++i)
        if (!finite.row(i).allFinite()) finite.row(i).setZero();
    return fcl_model_nodes(finite.data(), static_cast<int>(finite.rows()), faces.data(),
                           static_cast<int>(faces.rows()));
}

}  // namespace cloth
