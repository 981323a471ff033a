#include "data/authoring/waistband.h"

#include <algorithm>

namespace cloth {

// A short transition from the band to the cloth below would be a steep cone: thin triangles.
constexpr double gathering = 2.5;  // widths of the band

Points without_stretch(const Points& worn, double top, const GarmentRecipe& recipe) {
    const double band = top - recipe.band_width;
    const double gathered = gathering * recipe.band_width;
    Vec3 sum = Vec3::Zero();
    double count = 0.0;
    for (Eigen::Index i = 0; i < worn.rows(); ++i)
        if (worn(i, 1) > band) {
            sum += worn.row(i);
            count += 1.0;
        }
    const Vec3 centre = sum / std::max(1.0, count);
    Points rest = worn;
    for (Eigen::Index i = 0; i < worn.rows(); ++i) {
        const double t = std::clamp((band - worn(i, 1)) / gathered, 0.0, 1.0);
        if (t == 1.0) continue;  // keeps its bits
        const double ratio = recipe.band_ratio + t * (1.0 - recipe.band_ratio);
        for (int axis : {0, 2})
            rest(i, axis) = centre[axis] + ratio * (worn(i, axis) - centre[axis]);
    }
    return rest;
}

Points without_stretch(const Points& worn, const std::vector<int>& upper_edge, double width,
                       double ratio) {
    const Points edge = worn(upper_edge, Eigen::all);
    const Eigen::RowVector3d centre = edge.colwise().mean();
    Points rest = worn;
    for (Eigen::Index i = 0; i < worn.rows(); ++i) {
        Eigen::Index nearest = 0;
        (edge.rowwise() - worn.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
        const double depth = edge(nearest, 1) - worn(i, 1);
        const double t = std::clamp((depth - width) / (gathering * width), 0.0, 1.0);
        if (t == 1.0) continue;
        const double part = ratio + t * (1.0 - ratio);
        for (int axis : {0, 2})
            rest(i, axis) = centre[axis] + part * (worn(i, axis) - centre[axis]);
    }
    return rest;
}

}  // namespace cloth
