#include "data/authoring/tshirt.h"

#include <algorithm>
#include <cmath>

#include "data/authoring/mesh_quality.h"
#include "data/authoring/surface_edit.h"
#include "data/authoring/tshirt_shape.h"
#include "data/body/clearance.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

/// Negative on the side of a cut that stays; only vertices where `where` holds are cut.
template <typename Where, typename Level>
VectorX level_of(const Points& vertices, const Where& where, const Level& level) {
    VectorX values = VectorX::Constant(vertices.rows(), -1.0);
    for (Eigen::Index i = 0; i < vertices.rows(); ++i) {
        const Vec3 p = vertices.row(i);
        if (where(p)) values[i] = level(p);
    }
    return values;
}

TriMesh cut_hem(const TriMesh& mesh, const TshirtRecipe& recipe) {
    return cut_surface(mesh, recipe.hem_height - mesh.vertices.col(1).array());
}

/// Across the arm, near its axis only: the plane also meets the waist.
TriMesh cut_sleeve(const TriMesh& mesh, const TshirtRecipe& recipe, double side) {
    const Vec3 mirror(side, 1.0, 1.0);
    const Vec3 shoulder = recipe.shoulder.cwiseProduct(mirror);
    const Vec3 arm = recipe.elbow.cwiseProduct(mirror) - shoulder;
    const Vec3 end = shoulder + recipe.sleeve_length * arm;
    const double reach = 0.11;
    return cut_surface(mesh,
                       level_of(
                           mesh.vertices, [&](const Vec3& p) { return (p - end).norm() < reach; },
                           [&](const Vec3& p) { return (p - end).dot(arm.normalized()); }));
}

/// An elliptic cone around the neck that widens upwards.
TriMesh cut_neck(const TriMesh& mesh, const TshirtRecipe& recipe) {
    const double tilt = recipe.neck_tilt * M_PI / 180.0;
    const Vec3 up(0.0, std::cos(tilt), std::sin(tilt)), front(0.0, -up.z(), up.y());
    const auto inside = [&](const Vec3& p) {
        const Vec3 q = p - recipe.neck;
        const double wider = std::max(0.1, 1.0 + q.dot(up) / 0.10);
        const double u = q.x() / (recipe.neck_half_width * wider);
        const double v = q.dot(front) / (recipe.neck_half_depth * wider);
        return (1.0 - std::sqrt(u * u + v * v)) * recipe.neck_half_width;
    };
    return cut_surface(
        mesh, level_of(
                  mesh.vertices, [&](const Vec3& p) { return (p - recipe.neck).dot(up) > -0.05; },
                  inside));
}

void check_result(const TriMesh& shirt) {
    const Topology shape = topology(shirt.faces);
    if (!shape.manifold || !shape.oriented || shape.components != 1 || shape.boundary_loops != 4 ||
        shape.euler_characteristic != -2)
        throw ArgumentError("TshirtRecipe",
                            "the cuts leave " + std::to_string(shape.boundary_loops) +
                                " openings instead of neck, hem and two sleeves",
                            "check shoulder, elbow, armpit, neck and hem against the body");
}

}  // namespace

TriMesh make_tshirt(const TriMesh& body_rest, const TshirtRecipe& recipe) {
    check_tshirt_recipe(recipe);
    TriMesh shirt = tshirt_surface(body_rest, recipe);
    shirt = cut_neck(shirt, recipe);
    shirt = cut_hem(shirt, recipe);
    for (double side : {1.0, -1.0}) shirt = cut_sleeve(shirt, recipe, side);
    const Vec3 chest(0.0, recipe.armpit.y() - 0.1, 0.3);
    shirt = keep_component(shirt, chest);
    check_result(shirt);
    shirt = remesh(shirt, recipe.target_vertices);
    if (push_out(shirt, SurfaceDistance(body_rest), recipe.clearance) < recipe.clearance)
        throw ArgumentError("TshirtRecipe", "the T-shirt cannot be kept outside the body",
                            "check shoulder, elbow and armpit, or raise the eases");
    return shirt;
}

}  // namespace cloth
