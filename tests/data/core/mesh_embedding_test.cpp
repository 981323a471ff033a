#include "data/core/mesh_embedding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/core/errors.h"
#include "tests/test_meshes.h"

namespace cloth::mesh_embedding_test {
namespace {

using namespace test;

TriMesh with_noise(TriMesh mesh, double size, unsigned seed) {
    std::mt19937 random(seed);
    mesh.vertices += random_points(random, mesh.vertices.rows(), size);
    return mesh;
}

/// A sheet of 1 m x 1 m, rolled up on a cylinder of radius `radius` (m) along z.
Points rolled(const Points& flat, double radius) {
    Points x(flat.rows(), 3);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const double angle = (flat(i, 0) - 0.5) / radius, r = radius + flat(i, 1);
        x.row(i) << r * std::sin(angle), r * std::cos(angle) - radius, flat(i, 2);
    }
    return x;
}

double farthest_from(const Points& a, const Points& b) {
    return (a - b).rowwise().norm().maxCoeff();
}

TEST(MeshEmbedding, CoarseVerticesAtRestGiveTheFineMeshItsOwnShape) {
    const TriMesh coarse = icosphere(2), fine = with_noise(icosphere(4), 0.01, 1);
    const MeshEmbedding embedding(coarse, fine, {0.1});
    Points x;
    embedding.positions(coarse.vertices, x);
    EXPECT_LT(farthest_from(x, fine.vertices), 1e-12);
    EXPECT_GT(embedding.farthest(), 1e-3) << "the meshes differ";
    EXPECT_LT(embedding.farthest(), 0.1);
}

TEST(MeshEmbedding, RigidMotionIsTakenAlong) {
    const TriMesh coarse = icosphere(2), fine = with_noise(icosphere(4), 0.01, 2);
    const MeshEmbedding embedding(coarse, fine, {0.1});
    const Pose pose = pose_of({3, -2, 1}, 2.2, Vec3(1, 2, -1).normalized());
    const auto moved = [&](const Points& x) {
        return Points((x * pose.linear().transpose()).rowwise() + pose.translation().transpose());
    };
    Points x;
    embedding.positions(moved(coarse.vertices), x);
    EXPECT_LT(farthest_from(x, moved(fine.vertices)), 1e-12);
}

TEST(MeshEmbedding, AFineSheetOnARolledCoarseOneIsRound) {
    const TriMesh coarse = square_mesh(17), fine = square_mesh(113);
    const MeshEmbedding embedding(coarse, fine);
    Points x, flat;
    embedding.positions(rolled(coarse.vertices, 0.25), x);
    embedding.interpolate(rolled(coarse.vertices, 0.25), flat);
    const Points round = rolled(fine.vertices, 0.25);
    double error = 0.0, flat_error = 0.0;
    for (Eigen::Index i = 0; i < round.rows(); ++i) {
        // At the border the coarse normals are those of one side.
        if (std::abs(fine.vertices(i, 0) - 0.5) > 0.43) continue;
        error = std::max(error, (x.row(i) - round.row(i)).norm());
        flat_error = std::max(flat_error, (flat.row(i) - round.row(i)).norm());
    }
    EXPECT_GT(flat_error, 1.9e-3) << "the sagitta of a coarse edge";
    EXPECT_LT(error, 0.2 * flat_error);
}

TEST(MeshEmbedding, VerticesOffTheCoarseMeshKeepTheirHeight) {
    const TriMesh coarse = square_mesh(17);
    TriMesh fine = square_mesh(60);
    fine.vertices.col(1).setConstant(0.02);
    const MeshEmbedding embedding(coarse, fine);
    Points x;
    embedding.positions(rolled(coarse.vertices, 0.25), x);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (std::abs(fine.vertices(i, 0) - 0.5) > 0.43) continue;
        EXPECT_NEAR(Vec3(x(i, 0), x(i, 1) + 0.25, 0).norm(), 0.27, 5e-4);
    }
}

TEST(MeshEmbedding, LayersAreToldApartByTheirSides) {
    // Two coarse layers 10 mm apart that look away from each other; the fine ones are nearer to
    // the wrong layer.
    TriMesh coarse = square_mesh(5), fine = square_mesh(9);
    const auto doubled = [](const TriMesh& sheet, double upper) {
        TriMesh both{Points(2 * sheet.vertices.rows(), 3), Faces(2 * sheet.faces.rows(), 3)};
        both.vertices << sheet.vertices, sheet.vertices;
        both.vertices.topRows(sheet.vertices.rows()).col(1).setConstant(upper);
        const Faces below = sheet.faces.array() + static_cast<int>(sheet.vertices.rows());
        both.faces << sheet.faces, below.rowwise().reverse();
        return both;
    };
    const MeshEmbedding embedding(doubled(coarse, 0.010), doubled(fine, 0.004));
    for (Eigen::Index i = 0; i < embedding.size(); ++i) {
        const bool above = i < fine.vertices.rows();
        for (const int corner : embedding.corners(i))
            EXPECT_EQ(corner < coarse.vertices.rows(), above) << i;
    }
}

TEST(MeshEmbedding, InterpolationIsExactForLinearFields) {
    const TriMesh coarse = square_mesh(6), fine = square_mesh(31);
    const MeshEmbedding embedding(coarse, fine);
    Eigen::Matrix3d field;
    field << 1, 2, 3, -4, 5, 6, 7, -8, 9;
    Points values;
    embedding.interpolate(coarse.vertices * field, values);
    EXPECT_LT(farthest_from(values, fine.vertices * field), 1e-12);
}

TEST(MeshEmbedding, ACollapsedFaceGivesFinitePositions) {
    const TriMesh coarse = icosphere(1), fine = with_noise(icosphere(3), 0.01, 3);
    const MeshEmbedding embedding(coarse, fine, {0.2});
    Points x;
    embedding.positions(Points::Constant(coarse.vertices.rows(), 3, 0.5), x);
    EXPECT_TRUE(x.allFinite());
    EXPECT_LT(farthest_from(x, Points::Constant(x.rows(), 3, 0.5)), 1e-9);
}

TEST(MeshEmbedding, MeshesThatDoNotFitAreRefused) {
    const TriMesh coarse = square_mesh(5);
    TriMesh fine = square_mesh(9);
    fine.vertices.col(1).array() += 0.05;
    EXPECT_THROW(MeshEmbedding(coarse, fine), ArgumentError);
    EXPECT_NO_THROW(MeshEmbedding(coarse, fine, {0.06}));
    EXPECT_THROW(MeshEmbedding(coarse, fine, {2.0}), ArgumentError);
    fine.vertices(7, 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(MeshEmbedding(coarse, fine), ArgumentError);
    Points x;
    const MeshEmbedding embedding(coarse, square_mesh(9));
    EXPECT_THROW(embedding.positions(Points::Zero(7, 3), x), ArgumentError);
    EXPECT_THROW(embedding.interpolate(Points::Zero(7, 3), x), ArgumentError);
}

}  // namespace
}  // namespace cloth::mesh_embedding_test
