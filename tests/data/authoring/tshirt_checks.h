#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "data/authoring/mesh_quality.h"
#include "data/core/surface_distance.h"

namespace cloth::test {

/// What holds for every T-shirt, whatever its resolution.
inline void expect_tshirt(const TriMesh& shirt, const SurfaceDistance& body, int target_vertices) {
    EXPECT_NEAR(static_cast<double>(shirt.vertices.rows()), target_vertices,
                0.03 * target_vertices);
    validate_mesh("shirt", shirt);
    const Topology shape = topology(shirt.faces);
    EXPECT_TRUE(shape.manifold);
    EXPECT_TRUE(shape.oriented);
    EXPECT_EQ(shape.components, 1);
    EXPECT_EQ(shape.boundary_loops, 4);
    EXPECT_EQ(shape.euler_characteristic, -2) << "genus 0 with four openings";
    EXPECT_GT(smallest_angle(shirt), 20.0);
    EXPECT_NEAR(mean_inner_degree(shirt), 6.0, 0.1);
    EXPECT_GE(smallest_clearance(shirt, body), 0.004);
    const VectorX areas = face_area_vectors(shirt.vertices, shirt.faces).rowwise().norm();
    EXPECT_GT(areas.maxCoeff(), 1.2 * areas.minCoeff()) << "a regular grid";
}

/// Mean position of a loop of vertices.
inline Vec3 centre_of(const TriMesh& mesh, const std::vector<int>& loop) {
    Vec3 sum = Vec3::Zero();
    for (int i : loop) sum += mesh.vertices.row(i);
    return sum / static_cast<double>(loop.size());
}

/// The openings: hem, neck, left sleeve (+x), right sleeve.
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
