#pragma once

#include <cmath>
#include <utility>

#include "data/authoring/sheet.h"
#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "data/core/garment_pieces.h"

/// Scenes in which cloth meets itself or other cloth.
namespace cloth::test {

struct LayerScene {
    Garment garment;
    ClothState start;
    Boundary boundary;
};

inline Boundary outside(std::vector<Obstacle> obstacles) {
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    boundary.obstacles = std::move(obstacles);
    return boundary;
}

inline Obstacle floor_at(double height) {
    Obstacle floor;
    floor.shape = ObstacleShape::plane;
    floor.pose0.translation().y() = floor.pose1.translation().y() = height;
    return floor;
}

inline Obstacle ball(double radius) {
    Obstacle sphere;
    sphere.shape = ObstacleShape::sphere;
    sphere.radius = radius;
    return sphere;
}

/// A sheet folded in half like a book, fold at the left, `height` (m) above the floor.
inline LayerScene folded_sheet(int vertices = 400, double height = 0.05) {
    Garment garment("folded sheet", make_sheet(0.5, 0.25, vertices), Fabric::soft_cotton());
    ClothState start = ClothState::at_rest(garment);
    const double radius = 6e-3, arc = M_PI * radius;  // of the fold, which begins at -arc / 2
    for (Eigen::Index i = 0; i < start.x.rows(); ++i) {
        const double u = start.x(i, 0);
        const double angle = std::clamp((u + 0.5 * arc) / radius, 0.0, M_PI);
        const double beyond = u < -0.5 * arc ? -0.5 * arc - u : u > 0.5 * arc ? u - 0.5 * arc : 0.0;
        start.x.row(i) << beyond - radius * std::sin(angle),
            height + radius * (1.0 - std::cos(angle)), start.x(i, 2);
    }
    return {std::move(garment), std::move(start), outside({floor_at(0.0)})};
}

/// A narrow ribbon that hangs over the floor in a slight zigzag and falls on its end: a pile.
inline LayerScene falling_ribbon(int vertices = 300) {
    Garment garment("ribbon", make_sheet(0.9, 0.06, vertices), Fabric::soft_cotton());
    ClothState start = ClothState::at_rest(garment);
    for (Eigen::Index i = 0; i < start.x.rows(); ++i) {
        const double u = start.x(i, 0);
        start.x.row(i) << 0.01 * std::sin(12.0 * u), u + 0.5, start.x(i, 2) + 0.005 * u;
    }
    return {std::move(garment), std::move(start), outside({floor_at(0.0)})};
}

/// A sheet that lies on a ball, and a smaller one that falls on it.
inline LayerScene sheet_on_sheet(int vertices = 300) {
    TriMesh above = make_sheet(0.3, 0.3, vertices / 2, 2);
    above.vertices.col(1).array() += 0.04;
    Garment garment =
        merge_garments("two sheets",
                       {Garment("below", make_sheet(0.4, 0.4, vertices), Fabric::soft_cotton()),
                        Garment("above", above, Fabric::soft_cotton())})
            .garment;
    ClothState start = ClothState::at_rest(garment);
    start.x.col(1).array() += 0.155;
    return {std::move(garment), std::move(start), outside({ball(0.15)})};
}

/// Two sheets that pass through each other along a line.
inline LayerScene tangled_sheets(int vertices = 150) {
    Garment garment =
        merge_garments(
            "tangled sheets",
            {Garment("one", make_sheet(0.3, 0.3, vertices), Fabric::soft_cotton()),
             Garment("other", make_sheet(0.25, 0.25, vertices, 2), Fabric::soft_cotton())})
            .garment;
    ClothState start = ClothState::at_rest(garment);
    const std::vector<int> piece = garment_pieces(garment);
    for (Eigen::Index i = 0; i < start.x.rows(); ++i)
        start.x(i, 1) =
            0.06 + (piece[static_cast<size_t>(i)] == 1 ? 0.2 * start.x(i, 0) + 1e-3 : 0.0);
    return {std::move(garment), std::move(start), outside({floor_at(0.0)})};
}

}  // namespace cloth::test
