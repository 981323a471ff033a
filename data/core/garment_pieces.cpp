#include "data/core/garment_pieces.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "data/core/errors.h"

namespace cloth {
namespace {

bool same_fabric(const Fabric& a, const Fabric& b) {
    return a.density == b.density && a.mu == b.mu && a.lambda == b.lambda && a.bending == b.bending;
}

void check_can_merge(const std::vector<Garment>& garments) {
    if (garments.empty())
        throw ArgumentError("merge_garments", "there are no garments", "pass one or more");
    for (const Garment& garment : garments) {
        if (!same_fabric(garment.fabric(), garments.front().fabric()))
            throw ArgumentError(
                "merge_garments",
                garment.name() + " is of another fabric than " + garments.front().name(),
                "give all the same fabric with Garment::with_fabric()");
        if (garment.rest_angles_from_mesh() != garments.front().rest_angles_from_mesh())
            throw ArgumentError("merge_garments",
                                garment.name() + " takes its rest angles from elsewhere than " +
                                    garments.front().name(),
                                "make all with rest_angles, or none");
    }
}

/// The limits of all garments, one after the other; `otherwise` for those that have none.
VectorX merged(const std::vector<Garment>& garments, VectorX GoalLimits::*limit, double otherwise) {
    Eigen::Index vertices = 0;
    bool any = false;
    for (const Garment& garment : garments) {
        vertices += garment.vertex_count();
        any = any || (garment.goal_limits().*limit).size() > 0;
    }
    if (!any) return {};
    VectorX all = VectorX::Constant(vertices, otherwise);
    vertices = 0;
    for (const Garment& garment : garments) {
        const VectorX& own = garment.goal_limits().*limit;
        if (own.size() > 0) all.segment(vertices, own.size()) = own;
        vertices += garment.vertex_count();
    }
    return all;
}

GoalLimits merged_limits(const std::vector<Garment>& garments) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    GoalLimits limits;
    limits.max_distance = merged(garments, &GoalLimits::max_distance, infinity);
    limits.backstop = merged(garments, &GoalLimits::backstop, infinity);
    limits.drive_stiffness = merged(garments, &GoalLimits::drive_stiffness, 0.0);
    limits.drive_damping = merged(garments, &GoalLimits::drive_damping, 0.0);
    return limits;
}

}  // namespace

std::vector<int> garment_pieces(const Garment& garment) {
    std::vector<int> parent(static_cast<size_t>(garment.vertex_count()));
    for (size_t v = 0; v < parent.size(); ++v) parent[v] = static_cast<int>(v);
    const auto root = [&](int v) {
        while (parent[static_cast<size_t>(v)] != v) {
            int& above = parent[static_cast<size_t>(v)];
            above = parent[static_cast<size_t>(above)];
            v = above;
        }
        return v;
    };
    for (const auto& [a, b] : garment.edges()) {
        const int first = root(a), second = root(b);
        parent[static_cast<size_t>(std::max(first, second))] = std::min(first, second);
    }
    // A root is the first vertex of its piece, so it is numbered before the others need it.
    std::vector<int> piece(parent.size());
    int count = 0;
    for (size_t v = 0; v < parent.size(); ++v) {
        const int above = root(static_cast<int>(v));
        piece[v] = above == static_cast<int>(v) ? count++ : piece[static_cast<size_t>(above)];
    }
    return piece;
}

MergedGarments merge_garments(const std::string& name, const std::vector<Garment>& garments) {
    check_can_merge(garments);
    Eigen::Index vertices = 0, faces = 0;
    for (const Garment& garment : garments) {
        vertices += garment.vertex_count();
        faces += garment.face_count();
    }
    TriMesh mesh{Points(vertices, 3), Faces(faces, 3)};
    std::vector<int> first_vertex, pins;
    vertices = faces = 0;
    for (const Garment& garment : garments) {
        const int first = static_cast<int>(vertices);
        first_vertex.push_back(first);
        mesh.vertices.middleRows(vertices, garment.vertex_count()) = garment.rest().vertices;
        mesh.faces.middleRows(faces, garment.face_count()) = garment.rest().faces.array() + first;
        for (const int pin : garment.pins()) pins.push_back(first + pin);
        vertices += garment.vertex_count();
        faces += garment.face_count();
    }
    first_vertex.push_back(static_cast<int>(vertices));
    return {Garment(name, std::move(mesh), garments.front().fabric(), std::move(pins),
                    garments.front().rest_angles_from_mesh())
                .with_goals(merged_limits(garments)),
            std::move(first_vertex)};
}

}  // namespace cloth
