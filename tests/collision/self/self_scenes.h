#pragma once

#include <cmath>

#include "data/authoring/sheet.h"
#include "data/core/garment_pieces.h"
#include "tests/test_meshes.h"

namespace cloth::test {

/// A strip along x, wound up in a spiral around the z axis with `gap` (m) between the layers.
inline Points wound(const Points& rest, double gap) {
    const double first = 0.02;  // m: radius at which it begins
    const double start = rest.col(0).minCoeff();
    Points x = rest;
    for (Eigen::Index i = 0; i < rest.rows(); ++i) {
        // Archimedean spiral r = first + gap a / 2 pi; length to the angle a is nearly its
        // integral.
        const double length = rest(i, 0) - start, k = gap / (2 * M_PI);
        const double angle = (std::sqrt(first * first + 2 * k * length) - first) / k;
        const double radius = first + k * angle;
        x.row(i) << radius * std::cos(angle), radius * std::sin(angle), rest(i, 2);
    }
    return x;
}

inline Garment strip(int vertices = 300) {
    return Garment("strip", make_sheet(1.0, 0.1, vertices), Fabric::soft_cotton());
}

/// Two flat sheets, the second `gap` (m) above the first and of another triangulation.
inline MergedGarments two_sheets(double gap, int vertices = 150) {
    TriMesh above = make_sheet(0.3, 0.3, vertices, 2);
    above.vertices.col(1).array() += gap;
    return merge_garments("two sheets",
                          {Garment("below", make_sheet(0.3, 0.3, vertices), Fabric::soft_cotton()),
                           Garment("above", above, Fabric::soft_cotton())});
}

}  // namespace cloth::test
