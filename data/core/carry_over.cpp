#include "data/core/carry_over.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "data/core/errors.h"
#include "data/core/mesh_embedding.h"
#include "data/core/surface_distance.h"

namespace cloth {

namespace {

constexpr double kMost = 0.5;      // of a place
constexpr double kPinReach = 1.5;  // of a pin to the coarse pin that stands for it (edges)

/// Three vertices of a mesh, and what each of them counts at a place: 1 in all.
struct Place {
    std::array<int, 3> corners;
    Vec3 weights;
};

/// Values of the mesh's vertices that may be infinite, at places in it; none of none.
VectorX carried(const std::vector<Place>& places, const VectorX& values) {
    if (values.size() == 0) return {};
    VectorX result(static_cast<Eigen::Index>(places.size()));
    for (size_t i = 0; i < places.size(); ++i) {
        double finite = 0.0, infinite = 0.0;  // the mean, and the share without a value
        for (int c = 0; c < 3; ++c) {
            const double value = values[places[i].corners[static_cast<size_t>(c)]];
            if (std::isfinite(value))
                finite += places[i].weights[c] * value;
            else
                infinite += places[i].weights[c];
        }
        result[static_cast<Eigen::Index>(i)] =
            infinite > kMost ? std::numeric_limits<double>::infinity() : finite / (1.0 - infinite);
    }
    return result;
}

GoalLimits carried(const std::vector<Place>& places, const GoalLimits& painted) {
    GoalLimits limits;
    limits.max_distance = carried(places, painted.max_distance);
    limits.backstop = carried(places, painted.backstop);
    limits.drive_stiffness = carried(places, painted.drive_stiffness);
    limits.drive_damping = carried(places, painted.drive_damping);
    return limits;
}

std::vector<Place> places_of(const MeshEmbedding& embedding) {
    std::vector<Place> places;
    for (Eigen::Index i = 0; i < embedding.size(); ++i)
        places.push_back({embedding.corners(i), embedding.weights(i)});
    return places;
}

TriMesh faces_with_area(const TriMesh& mesh) {
    const VectorX areas = face_area_vectors(mesh.vertices, mesh.faces).rowwise().norm();
    std::vector<int> kept;
    for (Eigen::Index f = 0; f < areas.size(); ++f)
        if (areas[f] > 1e-14) kept.push_back(static_cast<int>(f));
    return {mesh.vertices, mesh.faces(kept, Eigen::all)};
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
    GoalLimits limits = carried(places_of(places), fine.goal_limits());
    Garment coarse = Garment(std::move(name), std::move(mesh), fine.fabric(),
                             carried_pins(places, fine), fine.rest_angles_from_mesh())
                         .with_goals(std::move(limits));
    check_pins(fine, coarse);
    return coarse;
}

GoalLimits limits_at(const Points& x, const TriMesh& mesh, const GoalLimits& limits) {
    check(limits, mesh.vertices.rows(), "limits_at()");
    TriMesh solid = faces_with_area(mesh);
    if (solid.faces.rows() == 0)
        throw ArgumentError("limits_at()", "no face of the mesh has an area",
                            "give the mesh that the limits are painted on");
    const SurfaceDistance surface(std::move(solid));
    std::vector<Place> places;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const NearestPoint nearest = surface.nearest(x.row(i));
        const auto face = surface.surface().faces.row(nearest.face);
        places.push_back({{face[0], face[1], face[2]}, nearest.weights});
    }
    return carried(places, limits);
}

}  // namespace cloth
