// Lines of the guide's table "of Bullet / here" that no other test is about.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "bullet_ext/softBodyGarment.h"
#include "gnn/model/make_cloth.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::supported_features_test {

using namespace cloth::test;

namespace {

constexpr int kNodes = 7;  // along a side

StepperFactory stepper() {
    return [](const Garment& garment) { return make_cloth(garment); };
}

/// Corners of a level square of 1 m and the triangles between them.
struct Grid {
    std::vector<btScalar> vertices;
    std::vector<int> corners;

    Grid() {
        for (int i = 0; i < kNodes * kNodes; ++i)
            for (const int at : {i % kNodes, -1, i / kNodes})
                vertices.push_back(at < 0 ? 0.3f : static_cast<btScalar>(at) / (kNodes - 1) - 0.5f);
        for (int row = 0; row + 1 < kNodes; ++row)
            for (int column = 0; column + 1 < kNodes; ++column) {
                const int a = row * kNodes + column, b = a + 1, c = a + kNodes, d = c + 1;
                for (const int corner : {a, c, b, b, c, d}) corners.push_back(corner);
            }
    }
};

btSoftBody* byHand(btSoftBodyWorldInfo& info) {
    const Grid grid;
    auto* body = new btSoftBody(&info);
    body->appendMaterial();
    for (size_t i = 0; i < grid.vertices.size(); i += 3)
        body->appendNode({grid.vertices[i], grid.vertices[i + 1], grid.vertices[i + 2]}, 1);
    for (size_t f = 0; f < grid.corners.size(); f += 3) {
        const int* at = &grid.corners[f];
        for (int k = 0; k < 3; ++k) body->appendLink(at[k], at[(k + 1) % 3], nullptr, true);
        body->appendFace(at[0], at[1], at[2]);
    }
    return body;
}

btSoftBody* ofTriangles(btSoftBodyWorldInfo& info) {
    const Grid grid;
    return btSoftBodyHelpers::CreateFromTriMesh(info, grid.vertices.data(), grid.corners.data(),
                                                static_cast<int>(grid.corners.size() / 3));
}

btSoftBody* withTextureCoordinates(btSoftBodyWorldInfo& info) {
    return btSoftBodyHelpers::CreatePatchUV(info, {-0.5f, 0.3f, -0.5f}, {0.5f, 0.3f, -0.5f},
                                            {-0.5f, 0.3f, 0.5f}, {0.5f, 0.3f, 0.5f}, kNodes, kNodes,
                                            0, true);
}

/// Where a sheet ends that falls on a sphere after `change` of it.
Points fallen(const std::function<void(btSoftBody&)>& change) {
    btGnnSoftBodySolver solver(stepper());
    World world(&solver);
    world.add(new btSphereShape(0.3f), {0, 0, 0});
    btSoftBody* cloth = patch(world.info(), {0, 0.35f, 0}, kNodes);
    change(*cloth);
    world.add(cloth);
    world.step(1.0 / 60.0, 60);
    EXPECT_EQ(solver.status().clothBodies, 1);
    return nodePositions(*cloth);
}

}  // namespace

TEST(SupportedFeatures, SheetsOfEveryMakerAreCloth) {
    for (const auto& make : {byHand, ofTriangles, withTextureCoordinates}) {
        btGnnSoftBodySolver solver(stepper());
        World world(&solver);
        world.add(new btBoxShape({5, 0.5f, 5}), {0, -0.5f, 0});
        btSoftBody* cloth = world.add(make(world.info()));
        world.step(1.0 / 60.0, 90);
        EXPECT_EQ(solver.status().clothBodies, 1);
        EXPECT_TRUE(solver.status().messages.empty());
        ASSERT_TRUE(solver.garmentOf(cloth));
        EXPECT_NEAR(solver.garmentOf(cloth)->face_areas().sum(), 1.0, 1e-5);
        const Points x = nodePositions(*cloth);
        EXPECT_GT(x.col(1).minCoeff(), -1e-3);
        EXPECT_LT(x.col(1).maxCoeff(), 0.02) << "it has fallen down to the box";
    }
}

TEST(SupportedFeatures, HardnessesOfContactAndOtherIterationsChangeNothing) {
    const Points as_it_is = fallen([](btSoftBody&) {});
    const Points changed = fallen([](btSoftBody& body) {
        btSoftBody::Config& config = body.m_cfg;
        config.kVCF = 0.3f;
        config.kCHR = 0.2f;
        config.kKHR = 0.4f;
        config.kSHR = 0.5f;
        config.viterations = 3;
        config.diterations = 4;
        config.citerations = 5;
    });
    EXPECT_EQ(as_it_is, changed);
}

TEST(SupportedFeatures, BothKindsOfCollisionWithRigidBodiesMeanTheSame) {
    const auto with = [](int flags) {
        return fallen([flags](btSoftBody& body) { body.m_cfg.collisions = flags; });
    };
    EXPECT_EQ(with(btSoftBody::fCollision::SDF_RS), with(btSoftBody::fCollision::CL_RS));
}

// Bullet's links are as stiff as iterations make them.
TEST(SupportedFeatures, StiffnessIsReadOnceAndDoesNotDependOnIterations) {
    const auto hanging = [](int iterations, btScalar stiffness_later, bool attach_again) {
        btGnnSoftBodySolver solver(stepper());
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, kNodes, 1 + 2));
        cloth->m_cfg.piterations = iterations;
        world.step(1.0 / 60.0);
        cloth->m_materials[0]->m_kLST = stiffness_later;
        if (attach_again) solver.attach(cloth);
        world.step(1.0 / 60.0, 60);
        return nodePositions(*cloth);
    };
    const auto most_stretch = [](const Points& x) {
        double longest = 0.0;
        for (Eigen::Index i = 0; i + kNodes < x.rows(); ++i)
            longest = std::max(longest, (x.row(i + kNodes) - x.row(i)).norm());
        return longest * (kNodes - 1) - 1.0;  // of a sheet of one metre
    };
    const Points once = hanging(1, 1, false);
    EXPECT_EQ(once, hanging(10, 1, false));
    EXPECT_EQ(once, hanging(1, 0.02f, false));
    EXPECT_GT(most_stretch(hanging(1, 0.02f, true)), 2.0 * most_stretch(once))
        << "attached again it is softer";
}

TEST(SupportedFeatures, MovedAndTurnedInMidRunClothKeepsItsShapeAndVelocity) {
    btGnnSoftBodySolver solver(stepper());
    World world(&solver);
    world->setGravity({0, 0, 0});
    world.info().m_gravity.setZero();
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, kNodes));
    world.step(1.0 / 60.0, 5);
    const std::vector<double> lengths = lengthsAt(*cloth, nodePositions(*cloth));
    cloth->translate({1, 2, 3});
    cloth->rotate(btQuaternion({0, 0, 1}, SIMD_HALF_PI));
    cloth->transform(btTransform(btQuaternion({1, 0, 0}, 0.5f), {0, 1, 0}));
    const Points placed = nodePositions(*cloth);
    ASSERT_GT(placed.rowwise().norm().minCoeff(), 1.0);
    world.step(1.0 / 60.0, 5);
    EXPECT_EQ(solver.status().clothBodies, 1);
    EXPECT_LT((nodePositions(*cloth) - placed).cwiseAbs().maxCoeff(), 1e-4);
    const std::vector<double> now = lengthsAt(*cloth, nodePositions(*cloth));
    for (size_t i = 0; i < lengths.size(); ++i) EXPECT_NEAR(now[i], lengths[i], 1e-4);
}

}  // namespace cloth::supported_features_test
