#pragma once

#include <cmath>
#include <random>

#include "tests/gnn/physics/stepper/self_contact_scenes.h"

/// Scenes of cloth that has passed through itself or through other cloth, in free space.
namespace cloth::test {

inline LayerScene in_free_space(Garment garment, Points x) {
    ClothState start = ClothState::at_rest(garment);
    start.x = std::move(x);
    LayerScene scene{std::move(garment), std::move(start), outside({})};
    scene.boundary.gravity.setZero();
    return scene;
}

/// Bends a flat sheet, which lies level, about a line in it: what is on the left of the line
/// through `through` along `along` is turned up about it by `angle`, over an arc of `radius` (m).
inline Points bent(const Points& flat, const Vec3& through, const Vec3& along, double angle,
                   double radius) {
    const Vec3 axis = along.normalized(), aside = axis.cross(Vec3::UnitY());
    Points x = flat;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const Vec3 from = flat.row(i).transpose() - through;
        const double s = from.dot(aside);
        if (s <= 0.0) continue;
        const double turned = std::min(s / radius, angle), rest = s - turned * radius;
        x.row(i) = (through + from.dot(axis) * axis +
                    (radius * std::sin(turned) + rest * std::cos(turned)) * aside +
                    (radius * (1.0 - std::cos(turned)) + rest * std::sin(turned)) * Vec3::UnitY())
                       .transpose();
    }
    return x;
}

/// A sheet of which a corner is folded over so far that it has gone through the sheet.
inline LayerScene corner_through_itself(int vertices = 300) {
    Garment garment("sheet", make_sheet(0.3, 0.3, vertices), Fabric::soft_cotton());
    const Points x = bent(garment.rest().vertices, Vec3(0.02, 0.0, 0.02), Vec3(1.0, 0.0, -1.0),
                          1.12 * M_PI, 0.012);
    return in_free_space(std::move(garment), x);
}

/// A level sheet through which a corner of an upright one has gone.
inline LayerScene corner_through_sheet(int vertices = 200, double depth = 0.04) {
    TriMesh upright = make_sheet(0.2, 0.2, vertices, 2);
    for (Eigen::Index i = 0; i < upright.vertices.rows(); ++i) {
        const double u = upright.vertices(i, 0), v = upright.vertices(i, 2);
        upright.vertices.row(i) << (u - v) * M_SQRT1_2 + 0.0013,
            (u + v) * M_SQRT1_2 + 0.2 * M_SQRT1_2 - depth, 0.0021;
    }
    Garment garment =
        merge_garments("sheets",
                       {Garment("level", make_sheet(0.3, 0.3, vertices), Fabric::soft_cotton()),
                        Garment("upright", upright, Fabric::soft_cotton())})
            .garment;
    Points x = garment.rest().vertices;
    return in_free_space(std::move(garment), x);
}

/// Two level sheets, the upper one with bumps that reach through the lower one.
inline LayerScene bump_through_sheet(int vertices = 250) {
    TriMesh above = make_sheet(0.3, 0.3, vertices, 2);
    for (Eigen::Index i = 0; i < above.vertices.rows(); ++i) {
        const double r2 = above.vertices.row(i).squaredNorm();
        above.vertices(i, 1) += 8e-3 - 0.025 * std::exp(-r2 / (0.06 * 0.06));
    }
    Garment garment =
        merge_garments("sheets",
                       {Garment("below", make_sheet(0.3, 0.3, vertices), Fabric::soft_cotton()),
                        Garment("above", above, Fabric::soft_cotton())})
            .garment;
    Points x = garment.rest().vertices;
    return in_free_space(std::move(garment), x);
}

/// A sheet that is folded by chance two or three times, in most cases through itself.
inline LayerScene folded_by_chance(unsigned seed, int vertices = 250) {
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
    };
    Garment garment("sheet", make_sheet(0.3, 0.3, vertices), Fabric::soft_cotton());
    Points x = garment.rest().vertices;
    const int folds = 2 + static_cast<int>(random() % 2);
    for (int k = 0; k < folds; ++k) {
        const double turn = between(0.0, 2.0 * M_PI);
        const Vec3 along(std::cos(turn), 0.0, std::sin(turn));
        const Vec3 aside = along.cross(Vec3::UnitY());
        x = bent(x, between(0.02, 0.08) * aside, along, between(0.9, 1.2) * M_PI,
                 between(0.008, 0.015));
    }
    return in_free_space(std::move(garment), x);
}

}  // namespace cloth::test
