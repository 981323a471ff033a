#pragma once

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "tests/gnn/physics/physics_scenes.h"

/// One step of a small garment, for the tests of solvers.
namespace cloth::test {

struct SolverScene {
    Garment garment;
    ClothState state;
    Boundary boundary;
};

inline Points rows_of(const Points& all, const std::vector<int>& rows) {
    Points chosen(static_cast<Eigen::Index>(rows.size()), 3);
    for (size_t k = 0; k < rows.size(); ++k)
        chosen.row(static_cast<Eigen::Index>(k)) = all.row(rows[k]);
    return chosen;
}

/// A sheet of 0.5 m in mid swing: horizontal, wavy, pinned at two corners, falling at 1 m/s.
inline SolverScene swinging_sheet(int n, Fabric fabric = Fabric::soft_cotton()) {
    Garment garment("sheet", sheet(n, 0.5), fabric, {0, n - 1});
    ClothState state = ClothState::at_rest(garment);
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        state.x(i, 1) = 0.02 * std::sin(9.0 * state.x(i, 0)) * state.x(i, 2);
        state.v.row(i) << 0.0, -2.0 * state.x(i, 2), 0.0;
    }
    Boundary boundary;
    boundary.pin_targets = rows_of(state.x, garment.pins());
    return {std::move(garment), std::move(state), std::move(boundary)};
}

inline Obstacle sphere(const Vec3& centre, double radius) {
    Obstacle obstacle;
    obstacle.shape = ObstacleShape::sphere;
    obstacle.radius = radius;
    obstacle.pose0.translation() = centre;
    obstacle.pose1 = obstacle.pose0;
    return obstacle;
}

/// A free sheet of 0.5 m that falls at 0.5 m/s, 6 mm above a sphere of 0.15 m.
inline SolverScene sheet_on_sphere(int n, Fabric fabric = Fabric::soft_cotton()) {
    Garment garment("sheet", sheet(n, 0.5), fabric);
    ClothState state = ClothState::at_rest(garment);
    state.v.col(1).setConstant(-0.5);
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    boundary.obstacles.push_back(sphere(Vec3(0.26, -0.156, 0.24), 0.15));
    return {std::move(garment), std::move(state), std::move(boundary)};
}

}  // namespace cloth::test
