#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "data/authoring/mesh_quality.h"
#include "data/core/surface_distance.h"

namespace cloth::test {

/// What holds for every garment as it is worn, whatever its resolution.
inline void expect_garment(const TriMesh& worn, const SurfaceDistance& body, int target_vertices,
                           int openings) {
    EXPECT_NEAR(static_cast<double>(worn.vertices.rows()), target_vertices, 0.03 * target_vertices);
    validate_mesh("garment", worn);
    const Topology shape = topology(worn.faces);
    EXPECT_TRUE(shape.manifold);
    EXPECT_TRUE(shape.oriented);
    EXPECT_EQ(shape.components, 1);
    EXPECT_EQ(shape.boundary_loops, openings);
    EXPECT_EQ(shape.euler_characteristic, 2 - openings) << "genus 0 with its openings";
    EXPECT_GT(smallest_angle(worn), 20.0);
    EXPECT_NEAR(mean_inner_degree(worn), 6.0, 0.1);
    EXPECT_GE(smallest_clearance(worn, body), 0.004);
    const VectorX areas = face_area_vectors(worn.vertices, worn.faces).rowwise().norm();
    EXPECT_GT(areas.maxCoeff(), 1.2 * areas.minCoeff()) << "a regular grid";
}

/// Length of a border (m) at positions of the vertices (|V| x 3).
inline double length_of(const Points& x, const std::vector<int>& loop) {
    double length = 0.0;
    for (size_t k = 0; k < loop.size(); ++k)
        length += (x.row(loop[k]) - x.row(loop[(k + 1) % loop.size()])).norm();
    return length;
}

/// Mean position of a loop of vertices.
inline Vec3 centre_of(const TriMesh& mesh, const std::vector<int>& loop) {
    Vec3 sum = Vec3::Zero();
    for (int i : loop) sum += mesh.vertices.row(i);
    return sum / static_cast<double>(loop.size());
}

/// The openings of a T-shirt: hem, neck, left sleeve (+x), right sleeve.
struct Openings {
    std::vector<int> hem, neck, left, right;
};

inline Openings openings_of(const TriMesh& shirt) {
    std::vector<std::vector<int>> loops = boundary_loops(shirt.faces);
    const auto x = [&](const std::vector<int>& loop) { return centre_of(shirt, loop).x(); };
    std::sort(loops.begin(), loops.end(),
              [&](const auto& a, const auto& b) { return x(a) < x(b); });
    Openings openings{loops.at(1), loops.at(2), loops.at(3), loops.at(0)};
    if (centre_of(shirt, openings.hem).y() > centre_of(shirt, openings.neck).y())
        std::swap(openings.hem, openings.neck);
    return openings;
}

}  // namespace cloth::test
