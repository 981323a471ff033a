#include "collision/response/embedded_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "collision/proximity/brute_force.h"
#include "data/core/errors.h"
#include "data/files/garment_assets.h"
#include "tests/test_meshes.h"

namespace cloth::embedded_mesh_test {
namespace {

using namespace test;

/// A sphere of radius 1 and a coarse garment around it that bulges into it in the middle of its
/// long edges.
struct Bodice {
    TriMesh coarse = icosphere(1), fine = icosphere(4);
    Boundary boundary = boundary_of({mesh_obstacle(icosphere(4))});

    Bodice() {
        coarse.vertices *= 1.001;
        fine.vertices *= 1.001;
    }
    EmbeddedMesh mesh(int threads = 0) const {
        EmbeddedMeshSettings settings;
        settings.embedding.reach = 0.2;
        settings.deepest = 0.1;
        settings.threads = threads;
        return EmbeddedMesh(coarse, fine, settings);
    }
    /// Flattened by half along z, so that the fine mesh cuts the sphere.
    Points squeezed() const {
        Points x = coarse.vertices;
        x.col(2) *= 0.95;
        return x;
    }
};

TEST(EmbeddedMesh, NoFineVertexIsNearerToAnObstacleThanTheDistance) {
    const Bodice bodice;
    EmbeddedMesh mesh = bodice.mesh();
    const ResolveReport report = mesh.follow(bodice.squeezed(), bodice.boundary);
    EXPECT_GT(report.max_depth_before, 0.03) << "the scene is no test";
    EXPECT_EQ(report.max_depth_after, 0.0);
    EXPECT_GT(report.moved, 100);
    for (Eigen::Index i = 0; i < mesh.vertices().rows(); ++i)
        EXPECT_GE(brute_force_signed_distance(bodice.boundary, StepEnd::end,
                                              mesh.vertices().row(i).transpose()),
                  1e-3 - 1e-8)
            << i;
}

TEST(EmbeddedMesh, WithoutObstaclesItIsTheEmbedding) {
    const Bodice bodice;
    EmbeddedMesh mesh = bodice.mesh();
    EXPECT_EQ(mesh.vertices(), bodice.fine.vertices) << "at rest before the first call";
    mesh.follow(bodice.squeezed(), Boundary());
    Points x;
    mesh.embedding().positions(bodice.squeezed(), x);
    EXPECT_EQ(mesh.vertices(), x);
    EXPECT_EQ(mesh.normals(), vertex_normals(x, bodice.fine.faces));
}

TEST(EmbeddedMesh, FineVerticesPassOverTheLimbsOfTheVerticesAroundThem) {
    Bodice bodice;
    Obstacle& ball = bodice.boundary.obstacles[0];
    ball.limbs = std::make_shared<const std::vector<std::uint8_t>>(
        static_cast<size_t>(ball.faces->rows()), std::uint8_t{3});
    EmbeddedMesh mesh = bodice.mesh();
    std::vector<LimbSet> ignored(static_cast<size_t>(bodice.coarse.vertices.rows()), 0);
    ignored[0] = LimbSet{1} << 3;
    mesh.follow(bodice.squeezed(), bodice.boundary, ignored);
    Points x;
    mesh.embedding().positions(bodice.squeezed(), x);
    int passed = 0, pushed = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const std::array<int, 3> corners = mesh.embedding().corners(i);
        if (std::find(corners.begin(), corners.end(), 0) != corners.end()) {
            EXPECT_EQ(Vec3(mesh.vertices().row(i)), Vec3(x.row(i))) << i;
            ++passed;
        } else {
            pushed += mesh.vertices().row(i) != x.row(i);
        }
    }
    EXPECT_GT(passed, 50);
    EXPECT_GT(pushed, 50);
}

TEST(EmbeddedMesh, TheWardrobesFineGarmentsFitTheirCoarseOnes) {
    for (const char* name : {"tshirt", "long_top", "skirt", "dress"}) {
        const TriMesh coarse = load_garment_mesh(std::string(name) + "_1000");
        const EmbeddedMesh mesh(coarse, load_garment_mesh(name));
        EXPECT_GT(mesh.vertices().rows(), 2 * coarse.vertices.rows()) << name;
        EXPECT_LT(mesh.embedding().farthest(), 0.01) << name;
    }
}

TEST(EmbeddedMesh, EqualBitsForAnyNumberOfThreads) {
    const Bodice bodice;
    EmbeddedMesh one = bodice.mesh(1), four = bodice.mesh(4);
    one.follow(bodice.squeezed(), bodice.boundary);
    four.follow(bodice.squeezed(), bodice.boundary);
    EXPECT_EQ(one.vertices(), four.vertices());
}

TEST(EmbeddedMesh, PositionsThatAreNotFiniteLeaveItAsItWas) {
    const Bodice bodice;
    EmbeddedMesh mesh = bodice.mesh();
    mesh.follow(bodice.squeezed(), bodice.boundary);
    const Points before = mesh.vertices();
    Points broken = bodice.coarse.vertices;
    broken(5, 1) = std::numeric_limits<double>::infinity();
    mesh.follow(broken, bodice.boundary);
    EXPECT_EQ(mesh.vertices(), before);
}

TEST(EmbeddedMesh, SettingsOutOfRangeAreRefused) {
    const Bodice bodice;
    EmbeddedMeshSettings settings;
    settings.distance = 0.006;
    EXPECT_THROW(EmbeddedMesh(bodice.coarse, bodice.fine, settings), ArgumentError);
    settings = {};
    settings.deepest = 0.2;
    EXPECT_THROW(EmbeddedMesh(bodice.coarse, bodice.fine, settings), ArgumentError);
}

}  // namespace
}  // namespace cloth::embedded_mesh_test
