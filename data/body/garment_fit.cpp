#include "data/body/garment_fit.h"

#include <array>
#include <string>
#include <vector>

#include "data/body/clearance.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/surface_distance.h"

namespace cloth {

namespace {

void check_bodies(const TriMesh& from, const Points& to) {
    if (to.rows() != from.vertices.rows())
        throw ArgumentError("fit_garment: body_to",
                            "it has " + std::to_string(to.rows()) + " vertices, body_from has " +
                                std::to_string(from.vertices.rows()),
                            "give the same body in another shape");
    for (Eigen::Index i = 0; i < to.rows(); ++i)
        if (!to.row(i).allFinite())
            throw ArgumentError("fit_garment: body_to",
                                "vertex " + std::to_string(i) + " is not finite",
                                "give finite positions in metres");
}

/// How the skin below each point of the garment moves (|V| x 3, m).
Points skin_displacement(const Points& garment, const SurfaceDistance& skin, const Points& to) {
    const TriMesh& from = skin.surface();
    Points displacement = Points::Zero(garment.rows(), 3);
    for (Eigen::Index i = 0; i < garment.rows(); ++i) {
        const NearestPoint near = skin.nearest(garment.row(i));
        for (int c = 0; c < 3; ++c) {
            const int corner = from.faces(near.face, c);
            displacement.row(i) += near.weights[c] * (to.row(corner) - from.vertices.row(corner));
        }
    }
    return displacement;
}

/// Every value moves half of the way to the mean of its neighbours, `rounds` times.
void even_out(Points& values, const std::vector<std::array<int, 2>>& edges, int rounds) {
    VectorX degree = VectorX::Zero(values.rows());
    for (const auto& [a, b] : edges) {
        degree[a] += 1.0;
        degree[b] += 1.0;
    }
    for (int round = 0; round < rounds; ++round) {
        Points sum = Points::Zero(values.rows(), 3);
        for (const auto& [a, b] : edges) {
            sum.row(a) += values.row(b);
            sum.row(b) += values.row(a);
        }
        for (Eigen::Index i = 0; i < values.rows(); ++i)
            values.row(i) = 0.5 * values.row(i) + 0.5 / degree[i] * sum.row(i);
    }
}

}  // namespace

Points fit_garment(const TriMesh& garment_rest, const TriMesh& body_from, const Points& body_to,
                   const GarmentFitSettings& settings) {
    check_range("GarmentFitSettings.clearance", settings.clearance, 1e-4, 0.05);
    check_range("GarmentFitSettings.smoothing", settings.smoothing, 0, 500);
    validate_mesh(settings.garment_name, garment_rest);
    check_bodies(body_from, body_to);
    Points displacement =
        skin_displacement(garment_rest.vertices, SurfaceDistance(body_from), body_to);
    even_out(displacement, undirected_edges(garment_rest.faces), settings.smoothing);
    TriMesh fitted{garment_rest.vertices + displacement, garment_rest.faces};
    const SurfaceDistance body({body_to, body_from.faces});
    if (push_out(fitted, body, settings.clearance) < settings.clearance)
        throw ArgumentError(settings.garment_name, "the garment cannot be kept clear of the body",
                            "give a body in the same pose, without parts that overlap, and model "
                            "the garment outside of the skin");
    return fitted.vertices;
}

}  // namespace cloth
