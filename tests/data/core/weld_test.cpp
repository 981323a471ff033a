#include "data/core/weld.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/core/errors.h"

namespace cloth::weld_test {

namespace {

/// Two triangles of a square that each bring their own corners, a hair apart.
TriMesh split_square(double gap) {
    TriMesh mesh;
    mesh.vertices.resize(6, 3);
    mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0,  //
        gap, 0, 0, 1, 1, gap, 0, 1, 0;
    mesh.faces.resize(2, 3);
    mesh.faces << 0, 1, 2, 3, 4, 5;
    return mesh;
}

}  // namespace

TEST(Weld, VerticesWithinTheToleranceBecomeTheFirstOfThem) {
    const WeldedMesh welded = weld_mesh(split_square(1e-4), 2e-4);
    EXPECT_EQ(welded.merged, 2);
    EXPECT_EQ(welded.dropped_faces, 0);
    EXPECT_EQ(welded.kept, (std::vector<int>{0, 1, 2, 5}));
    Faces faces(2, 3);
    faces << 0, 1, 2, 0, 2, 3;
    EXPECT_EQ(welded.mesh.faces, faces);
    EXPECT_EQ(welded.mesh.vertices.row(0), split_square(1e-4).vertices.row(0));
    EXPECT_EQ(undirected_edges(welded.mesh.faces).size(), 5u);  // one is shared
}

TEST(Weld, VerticesBeyondAMillionKilometresAreRefused) {
    TriMesh mesh = split_square(1e-4);
    mesh.vertices(5, 2) = 1e9;
    EXPECT_EQ(weld_mesh(mesh, 1e-300).merged, 0);
    mesh.vertices(5, 2) = -1.1e9;
    EXPECT_THROW(weld_mesh(mesh, 1e-4), ArgumentError);
}

TEST(Weld, VerticesFartherApartStay) {
    const WeldedMesh welded = weld_mesh(split_square(1e-4), 0.5e-4);
    EXPECT_EQ(welded.merged, 0);
    EXPECT_EQ(welded.mesh.vertices, split_square(1e-4).vertices);
    EXPECT_EQ(weld_mesh(split_square(0.0), 0.0).merged, 2);
}

TEST(Weld, TheToleranceHoldsAcrossTheCellsOfTheGrid) {
    // Every pair is a tolerance apart, in all directions and places of the grid.
    for (int step = 0; step < 200; ++step) {
        const Vec3 place(0.37 * step, -0.11 * step, 0.73 * step);
        const Vec3 way(std::sin(step), std::cos(step), std::sin(2.0 * step));
        TriMesh mesh = split_square(0.0);
        mesh.vertices.row(3) = mesh.vertices.row(0) + 0.99e-3 * way.normalized().transpose();
        mesh.vertices.rowwise() += place.transpose();
        EXPECT_EQ(weld_mesh(mesh, 1e-3).merged, 2) << step;
        EXPECT_EQ(weld_mesh(mesh, 0.9e-3).merged, 1) << step;
    }
}

TEST(Weld, FacesThatLoseTheirAreaAndTheirVerticesGo) {
    TriMesh mesh = split_square(0.0);
    mesh.vertices.row(5) = mesh.vertices.row(4);
    const WeldedMesh welded = weld_mesh(mesh, 1e-6);
    EXPECT_EQ(welded.dropped_faces, 1);
    EXPECT_EQ(welded.mesh.faces.rows(), 1);
    EXPECT_EQ(welded.kept, (std::vector<int>{0, 1, 2}));
}

TEST(Weld, UnusableArgumentsAreRefused) {
    EXPECT_THROW(weld_mesh(split_square(0.0), -1.0), ArgumentError);
    EXPECT_THROW(weld_mesh(split_square(0.0), 0.1), ArgumentError);
    EXPECT_THROW(weld_mesh(split_square(NAN), 1e-3), ArgumentError);
    TriMesh mesh = split_square(0.0);
    mesh.faces(1, 1) = 6;
    EXPECT_THROW(weld_mesh(mesh, 1e-3), ArgumentError);
}

}  // namespace cloth::weld_test
