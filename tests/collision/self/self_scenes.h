#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "collision/self/self_elements.h"
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

using Key = std::array<int, 3>;  // edges or not, the elements

inline Key key_of(const ElementPair& pair) {
    const auto [first, second] = pair.element;
    if (pair.edges) return {1, std::min(first, second), std::max(first, second)};
    return {0, first, second};
}

/// Every vertex with every face and every edge with every edge.
template <typename Visit>
void visit_all(const Garment& garment, const Visit& visit) {
    const Faces& faces = garment.rest().faces;
    for (int v = 0; v < garment.vertex_count(); ++v)
        for (int f = 0; f < faces.rows(); ++f)
            if ((faces.row(f).array() != v).all())
                visit(ElementPair{{v, faces(f, 0), faces(f, 1), faces(f, 2)}, {v, f}, false});
    const auto& edges = garment.edges();
    for (size_t a = 0; a < edges.size(); ++a)
        for (size_t b = a + 1; b < edges.size(); ++b) {
            const auto [p, q] = edges[a];
            const auto [r, s] = edges[b];
            if (p == r || p == s || q == r || q == s) continue;
            visit(ElementPair{{p, q, r, s}, {int(a), int(b)}, true});
        }
}

}  // namespace cloth::test
