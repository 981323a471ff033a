#include "gnn/physics/xpbd/spring_net.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth {
namespace {

/// Sum of the areas of the faces at each edge (m^2), in the order of garment.edges().
VectorX edge_areas(const Garment& garment) {
    const auto& edges = garment.edges();  // sorted
    VectorX areas = VectorX::Zero(static_cast<Eigen::Index>(edges.size()));
    for (Eigen::Index f = 0; f < garment.face_count(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const auto face = garment.rest().faces.row(f);
            const auto [low, high] = std::minmax({face[corner], face[(corner + 1) % 3]});
            const std::array<int, 2> edge = {low, high};
            const auto place = std::lower_bound(edges.begin(), edges.end(), edge);
            areas[place - edges.begin()] += garment.face_areas()[f];
        }
    return areas;
}

double youngs_modulus(const Fabric& fabric) {
    if (!(fabric.longitudinal() > 0.0)) return 0.0;  // cloth without stiffness
    return 4.0 * fabric.mu * (fabric.mu + fabric.lambda) / fabric.longitudinal();
}

/// The rest shape of a hinge: where the opposite corners stand over its edge.
struct HingeShape {
    double height0, height1;  ///< over the edge (m)
    double offset;            ///< between the feet of the two heights (m)
    double stiffness;         ///< k_h = k l^2 / (4 (A0 + A1)) (J)

    HingeShape(const Garment& garment, const Hinge& hinge) {
        const Points& rest = garment.rest().vertices;
        const Vec3 origin = rest.row(hinge[0]);
        const Vec3 edge = rest.row(hinge[1]).transpose() - origin;
        const Vec3 a = rest.row(hinge[2]).transpose() - origin;
        const Vec3 b = rest.row(hinge[3]).transpose() - origin;
        const double length = edge.norm();
        height0 = edge.cross(a).norm() / length;
        height1 = edge.cross(b).norm() / length;
        offset = edge.dot(a - b) / length;
        stiffness = garment.fabric().bending * length / (2.0 * (height0 + height1));
    }

    /// Distance of the opposite corners (m) when the hinge is folded by `angle` (rad).
    double distance(double angle) const {
        const double squared =
            height0 * height0 + height1 * height1 + 2.0 * height0 * height1 * std::cos(angle);
        return std::sqrt(squared + offset * offset);
    }
};

}  // namespace

std::vector<Spring> stretch_springs(const Garment& garment) {
    const VectorX areas = edge_areas(garment);
    const double young = youngs_modulus(garment.fabric());
    std::vector<Spring> springs;
    springs.reserve(garment.edges().size());
    for (const auto& [a, b] : garment.edges()) {
        const double length =
            (garment.rest().vertices.row(a) - garment.rest().vertices.row(b)).norm();
        const double area = areas[static_cast<Eigen::Index>(springs.size())];
        springs.push_back({a, b, length, young * area / (length * length),
                           std::numeric_limits<double>::infinity()});
    }
    return springs;
}

std::vector<Spring> bending_springs(const Garment& garment, double fitted_angle) {
    const double pi = std::acos(-1.0);
    std::vector<Spring> springs;
    springs.reserve(garment.hinges().size());
    for (const Hinge& hinge : garment.hinges()) {
        const HingeShape shape(garment, hinge);
        const Eigen::Index h = static_cast<Eigen::Index>(springs.size());
        const double rest_angle = std::abs(garment.hinge_rest_angles()[h]);
        const double folded =
            rest_angle + (rest_angle + fitted_angle < pi ? 1.0 : -1.0) * fitted_angle;
        const double rest_length = shape.distance(rest_angle);
        const double ratio = fitted_angle / (rest_length - shape.distance(folded));
        springs.push_back({hinge[2], hinge[3], rest_length, shape.stiffness * ratio * ratio,
                           shape.distance(0.0) - rest_length});
    }
    return springs;
}

}  // namespace cloth
