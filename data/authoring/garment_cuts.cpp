#include "data/authoring/garment_cuts.h"

#include <algorithm>
#include <cmath>

#include "data/authoring/garment_shape.h"
#include "data/authoring/sleeve.h"
#include "data/authoring/surface_edit.h"

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

/// Across the arm, near its axis only: the plane also meets the waist.
TriMesh cut_sleeve(const TriMesh& mesh, const BodyLandmarks& marks, const GarmentRecipe& recipe,
                   double side) {
    const SleeveEnd left = sleeve_end(marks, recipe);
    const Vec3 end = mirrored(left.point, side), direction = mirrored(left.direction, side);
    const double reach = 0.11;
    return cut_surface(mesh,
                       level_of(
                           mesh.vertices, [&](const Vec3& p) { return (p - end).norm() < reach; },
                           [&](const Vec3& p) { return (p - end).dot(direction); }));
}

/// A plane from the outer edge of the strap on the shoulder to the lowest point of the armhole.
TriMesh cut_armhole(const TriMesh& mesh, const BodyLandmarks& marks, const GarmentRecipe& recipe,
                    double side) {
    const Vec3 strap(recipe.neck_half_width + recipe.strap_width, marks.neck.y(), 0.0);
    const Vec3 lowest(marks.armpit.x() + recipe.ease, marks.armpit.y() - recipe.armhole_drop, 0.0);
    const Vec3 down = (lowest - strap).normalized();
    const Vec3 outside(-down.y(), down.x(), 0.0);
    return cut_surface(
        mesh, level_of(
                  mesh.vertices, [](const Vec3&) { return true; },
                  [&](const Vec3& p) { return (mirrored(p, side) - strap).dot(outside); }));
}

/// An elliptic cone around the neck that widens upwards.
TriMesh cut_neck(const TriMesh& mesh, const BodyLandmarks& marks, const GarmentRecipe& recipe) {
    const double tilt = recipe.neck_tilt * M_PI / 180.0;
    const Vec3 up(0.0, std::cos(tilt), std::sin(tilt)), front(0.0, -up.z(), up.y());
    const auto inside = [&](const Vec3& p) {
        const Vec3 q = p - marks.neck;
        const double wider = std::max(0.1, 1.0 + q.dot(up) / 0.10);
        const double u = q.x() / (recipe.neck_half_width * wider);
        const double v = q.dot(front) / (recipe.neck_half_depth * wider);
        return (1.0 - std::sqrt(u * u + v * v)) * recipe.neck_half_width;
    };
    return cut_surface(
        mesh, level_of(
                  mesh.vertices, [&](const Vec3& p) { return (p - marks.neck).dot(up) > -0.05; },
                  inside));
}

}  // namespace

TriMesh cut_garment(const TriMesh& surface, const BodyLandmarks& marks,
                    const GarmentRecipe& recipe) {
    const bool shoulders = recipe.from == GarmentRecipe::From::shoulders;
    const double top = waist_height(marks, recipe), hem = hem_height(marks, recipe);
    TriMesh mesh = shoulders ? cut_neck(surface, marks, recipe)
                             : cut_surface(surface, surface.vertices.col(1).array() - top);
    mesh = cut_surface(mesh, hem - mesh.vertices.col(1).array());
    if (shoulders)
        for (double side : {1.0, -1.0})
            mesh = recipe.sleeve_length > 0.0 ? cut_sleeve(mesh, marks, recipe, side)
                                              : cut_armhole(mesh, marks, recipe, side);
    return keep_component(mesh, Vec3(0.0, shoulders ? marks.armpit.y() - 0.1 : top - 0.05, 0.3));
}

}  // namespace cloth
