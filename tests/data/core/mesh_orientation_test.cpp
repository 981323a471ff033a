#include "data/core/mesh_orientation.h"

#include <gtest/gtest.h>

#include "data/core/mesh_pieces.h"
#include "tests/data/authoring/broken_garments.h"
#include "tests/test_meshes.h"

namespace cloth::mesh_orientation_test {

using namespace cloth::test;

namespace {

OrientationFaults faults_of(const TriMesh& mesh) {
    return orientation_faults(mesh.vertices, mesh.faces);
}

void turn(Faces& faces, int face) {
    std::swap(faces(face, 1), faces(face, 2));
}

/// Every triangle with vertices of its own.
TriMesh unindexed(const TriMesh& mesh) {
    TriMesh apart{Points(3 * mesh.faces.rows(), 3), mesh.faces};
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (Eigen::Index c = 0; c < 3; ++c) {
            apart.faces(f, c) = static_cast<int>(3 * f + c);
            apart.vertices.row(3 * f + c) = mesh.vertices.row(mesh.faces(f, c));
        }
    return apart;
}

}  // namespace

TEST(MeshOrientation, OrdinarySurfacesHaveNoFaults) {
    const TriMesh ball = icosphere(2);
    EXPECT_FALSE(faults_of(ball).any());
    EXPECT_FALSE(faults_of(unindexed(ball)).any());
    EXPECT_FALSE(faults_of(square_mesh(5)).any());
    EXPECT_FALSE(faults_of(turned(square_mesh(5))).any()) << "a sheet has no inside";
    EXPECT_FALSE(faults_of({Points(0, 3), Faces(0, 3)}).any());
    TriMesh collapsed = ball;
    collapsed.vertices.setZero();
    EXPECT_FALSE(faults_of(collapsed).any());
    EXPECT_FALSE(faults_of(together(ball, turned(scaled(ball, 0.9)))).any()) << "a cavity";
    TriMesh details = together(ball, turned(scaled(ball, 0.2)));
    details.vertices.bottomRows(ball.vertices.rows()).col(0).array() += 1.0;
    EXPECT_FALSE(faults_of(details).any()) << "an eye that looks in, half out of the head";
}

TEST(MeshOrientation, APersonAndOpenPartsOfOneHaveNoFaults) {
    EXPECT_FALSE(faults_of(person()).any());
    std::vector<char> shoes, scalp;
    for (Eigen::Index f = 0; f < person().faces.rows(); ++f) {
        const double y = person().vertices(person().faces(f, 0), 1);
        shoes.push_back(y < 0.1);
        scalp.push_back(y > 1.6);
    }
    EXPECT_FALSE(faults_of(keep_faces(person(), shoes)).any());
    EXPECT_FALSE(faults_of(keep_faces(person(), scalp)).any());
    EXPECT_EQ(faults_of(turned(person())).inside_out_face, 0);
}

TEST(MeshOrientation, TurnedFacesAreFound) {
    for (const bool indexed : {true, false}) {
        TriMesh ball = indexed ? icosphere(2) : unindexed(icosphere(2));
        turn(ball.faces, 17);
        EXPECT_EQ(faults_of(ball).turned_edges, 3);
        EXPECT_EQ(faults_of(ball).turned_face, 17);
        EXPECT_EQ(faults_of(ball).repeated_faces, 0);
        EXPECT_EQ(faults_of(ball).inside_out_face, -1);
    }
    TriMesh sheet = square_mesh(5);
    turn(sheet.faces, 0);
    EXPECT_GT(faults_of(sheet).turned_edges, 0);
}

TEST(MeshOrientation, FacesThatStandThereTwiceAreFound) {
    const TriMesh ball = icosphere(2);
    TriMesh doubled{ball.vertices, Faces(ball.faces.rows() + 2, 3)};
    doubled.faces << ball.faces, ball.faces.row(5), ball.faces.row(9);
    EXPECT_EQ(faults_of(doubled).repeated_faces, 0) << "they look to one side";
    turn(doubled.faces, static_cast<int>(ball.faces.rows()));
    turn(doubled.faces, static_cast<int>(ball.faces.rows()) + 1);
    EXPECT_EQ(faults_of(doubled).repeated_faces, 2);
    EXPECT_EQ(faults_of(doubled).repeated_face, ball.faces.rows());
}

TEST(MeshOrientation, ClosedPiecesThatLookInwardsAreFound) {
    const TriMesh ball = icosphere(2);
    EXPECT_EQ(faults_of(turned(ball)).inside_out_face, 0);
    EXPECT_EQ(faults_of(turned(ball)).turned_edges, 0);
    EXPECT_EQ(faults_of(unindexed(turned(ball))).inside_out_face, 0);
    std::vector<char> keep(static_cast<size_t>(ball.faces.rows()), 1);
    keep[3] = 0;
    EXPECT_EQ(faults_of(turned(keep_faces(ball, keep))).inside_out_face, 0) << "a small hole";
    TriMesh second = turned(ball);
    second.vertices.col(0).array() += 3.0;
    EXPECT_EQ(faults_of(together(ball, second)).inside_out_face, ball.faces.rows());
}

}  // namespace cloth::mesh_orientation_test
