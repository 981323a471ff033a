#include "data/core/mesh_repair.h"

#include <gtest/gtest.h>

#include "data/core/errors.h"
#include "tests/data/authoring/broken_garments.h"
#include "tests/test_meshes.h"

namespace cloth::mesh_repair_test {

using namespace cloth::test;

namespace {

TriMesh without_face(TriMesh mesh, Eigen::Index f) {
    std::vector<char> keep(static_cast<size_t>(mesh.faces.rows()), 1);
    keep[static_cast<size_t>(f)] = 0;
    return keep_faces(mesh, keep);
}

TriMesh square() {
    TriMesh mesh{Points(4, 3), Faces(2, 3)};
    mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
    mesh.faces << 0, 1, 2, 0, 2, 3;
    return mesh;
}

}  // namespace

TEST(MeshRepair, AGoodMeshStaysAsItIs) {
    const TriMesh good = without_face(icosphere(2), 7);
    const RepairedMesh repaired = repair_mesh(good);
    EXPECT_EQ(repaired.mesh.faces, good.faces);
    EXPECT_EQ(repaired.mesh.vertices, good.vertices);
    EXPECT_EQ(repaired.faces_without_area + repaired.duplicate_faces + repaired.cut_edges +
                  repaired.split_vertices + repaired.turned_faces + repaired.one_sided_pieces,
              0);
}

TEST(MeshRepair, FacesWithoutAreaAndDuplicatesAreLeftOut) {
    TriMesh mesh = square();
    mesh.vertices.conservativeResize(5, 3);
    mesh.vertices.row(4) << 0.5, 1e-9, 0;  // on the lower edge
    mesh.faces.conservativeResize(5, 3);
    mesh.faces.row(2) << 0, 4, 1;
    mesh.faces.row(3) << 2, 0, 1;  // again
    mesh.faces.row(4) << 2, 1, 0;  // and turned
    const RepairedMesh repaired = repair_mesh(mesh);
    EXPECT_EQ(repaired.faces_without_area, 1);
    EXPECT_EQ(repaired.duplicate_faces, 2);
    EXPECT_EQ(repaired.mesh.faces, square().faces);
}

TEST(MeshRepair, SquaresFromBothSidesAreOneHoweverTheyWereCut) {
    // A strip of squares with both sides, of which the second is cut along the other diagonals.
    constexpr int squares = 5;
    TriMesh mesh{Points(2 * squares + 2, 3), Faces(4 * squares, 3)};
    for (int k = 0; k <= squares; ++k) {
        mesh.vertices.row(2 * k) << k, 0, 0;
        mesh.vertices.row(2 * k + 1) << k, 1, 0.1 * (k % 2);
    }
    for (int k = 0; k < squares; ++k) {
        const int a = 2 * k, b = a + 2, c = a + 3, d = a + 1;
        mesh.faces.row(2 * k) << a, b, c;
        mesh.faces.row(2 * k + 1) << a, c, d;
        mesh.faces.row(2 * squares + 2 * k) << d, b, a;
        mesh.faces.row(2 * squares + 2 * k + 1) << d, c, b;
    }
    const RepairedMesh repaired = repair_mesh(mesh);
    EXPECT_EQ(repaired.duplicate_faces, 2 * squares);
    EXPECT_EQ(repaired.mesh.faces, Faces(mesh.faces.topRows(2 * squares)));
    EXPECT_EQ(repaired.cut_edges, 0);
    EXPECT_EQ(repaired.turned_faces, 0);
}

TEST(MeshRepair, ATetrahedronIsNoSquare) {
    TriMesh mesh{Points(4, 3), Faces(4, 3)};
    mesh.vertices << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
    mesh.faces << 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2;
    EXPECT_EQ(repair_mesh(mesh).duplicate_faces, 0);
}

TEST(MeshRepair, ThePairThatGoesOnStraightStaysTogether) {
    const RepairedMesh repaired = repair_mesh(with_fin(square(), 0, 2, {0.5, 0.5, 1.0}));
    EXPECT_EQ(repaired.cut_edges, 1);
    EXPECT_EQ(repaired.split_vertices, 2);
    const Topology shape = topology(repaired.mesh.faces);
    EXPECT_TRUE(shape.manifold);
    EXPECT_EQ(shape.components, 2);
    EXPECT_EQ(repaired.mesh.faces.topRows(2), square().faces);
}

TEST(MeshRepair, PartsThatMeetInAVertexAreSplitThere) {
    TriMesh mesh = together(square(), square());
    mesh.vertices.bottomRows(4).rowwise() += Eigen::RowVector3d(1, 1, 0);
    for (int c = 0; c < 3; ++c)
        for (int f : {2, 3})
            if (mesh.faces(f, c) == 4) mesh.faces(f, c) = 2;  // a bow tie
    EXPECT_FALSE(topology(mesh.faces).manifold);
    const RepairedMesh repaired = repair_mesh(mesh);
    EXPECT_EQ(repaired.split_vertices, 1);
    EXPECT_TRUE(topology(repaired.mesh.faces).manifold);
    EXPECT_EQ(topology(repaired.mesh.faces).components, 2);
}

TEST(MeshRepair, FacesAreTurnedAsMostOfTheirPieceAre) {
    TriMesh mesh = without_face(icosphere(2), 0);
    std::swap(mesh.faces(5, 1), mesh.faces(5, 2));
    std::swap(mesh.faces(90, 1), mesh.faces(90, 2));
    const RepairedMesh repaired = repair_mesh(mesh);
    EXPECT_EQ(repaired.turned_faces, 2);
    EXPECT_TRUE(topology(repaired.mesh.faces).oriented);
    EXPECT_GT(signed_volume(repaired.mesh), 0.0);
}

TEST(MeshRepair, AMoebiusStripIsCountedAndLeftAlone) {
    const TriMesh strip = moebius(30);
    const RepairedMesh repaired = repair_mesh(strip);
    EXPECT_EQ(repaired.one_sided_pieces, 1);
    EXPECT_EQ(repaired.mesh.faces, strip.faces);
}

TEST(MeshRepair, WhatHasNoFaceLeftIsRefused) {
    TriMesh line = square();
    line.vertices.col(1).setZero();
    EXPECT_THROW(repair_mesh(line), ArgumentError);
    EXPECT_THROW(repair_mesh({Points(0, 3), Faces(0, 3)}), ArgumentError);
}

}  // namespace cloth::mesh_repair_test
