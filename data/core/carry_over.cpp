#include "data/core/carry_over.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "data/core/errors.h"
#include "data/core/mesh_embedding.h"

namespace cloth {

namespace {

constexpr double kMost = 0.5;      // of a place
constexpr double kPinReach = 1.5;  // of a pin to the coarse pin that stands for it (edges)

/// Values of the fine vertices that may be infinite, at the places of the coarse ones; none of
/// none.
VectorX carried(const MeshEmbedding& places, const VectorX& values) {
    if (values.size() == 0) return {};
    Points finite = Points::Zero(values.size(), 3);  // the value, or that there is none
    for (Eigen::Index i = 0; i < values.size(); ++i)
        finite(i, std::isfinite(values[i]) ? 0 : 1) = std::isfinite(values[i]) ? values[i] : 1.0;
    Points means;
    places.interpolate(finite, means);
    VectorX result(means.rows());
    for (Eigen::Index i = 0; i < means.rows(); ++i)
        result[i] = means(i, 1) > kMost ? std::numeric_limits<double>::infinity()
                                        : means(i, 0) / (1.0 - means(i, 1));
    return result;
}

std::vector<int> carried_pins(const MeshEmbedding& places, const Garment& fine) {
    std::vector<int> pins;
    for (Eigen::Index i = 0; i < places.size(); ++i) {
        const std::array<int, 3> corners = places.corners(i);
        double share = 0.0;
        for (int c = 0; c < 3; ++c)
            if (fine.is_pinned()[static_cast<size_t>(corners[static_cast<size_t>(c)])])
                share += places.weights(i)[c];
        if (share > kMost) pins.push_back(static_cast<int>(i));
    }
    return pins;
}

void check_pins(const Garment& fine, const Garment& coarse) {
    const double reach = kPinReach * coarse.mean_edge_length();
    for (const int pin : fine.pins()) {
        const Vec3 p = fine.rest().vertices.row(pin);
        const bool held = std::any_of(coarse.pins().begin(), coarse.pins().end(), [&](int other) {
            return (coarse.rest().vertices.row(other).transpose() - p).norm() <= reach;
        });
        if (!held)
            throw ArgumentError(
                coarse.name() + ": pin " + std::to_string(pin) + " of " + fine.name(),
                "no vertex of the coarse mesh is where it is, so it would hang "
                "from nothing",
                "give the coarse mesh a vertex there, or more vertices");
    }
}

}  // namespace

Garment carry_over(const Garment& fine, TriMesh mesh, std::string name) {
    const MeshEmbedding places(fine.rest(), mesh);
    const GoalLimits& painted = fine.goal_limits();
    GoalLimits limits;
    limits.max_distance = carried(places, painted.max_distance);
    limits.backstop = carried(places, painted.backstop);
    limits.drive_stiffness = carried(places, painted.drive_stiffness);
    limits.drive_damping = carried(places, painted.drive_damping);
    Garment coarse = Garment(std::move(name), std::move(mesh), fine.fabric(),
                             carried_pins(places, fine), fine.rest_angles_from_mesh())
                         .with_goals(std::move(limits));
    check_pins(fine, coarse);
    return coarse;
}

}  // namespace cloth
