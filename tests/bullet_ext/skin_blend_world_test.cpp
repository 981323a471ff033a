// What is shown of a body fades to its skin and back: fadeToSkin(), shownPositions().
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bullet_ext/softBodyGarment.h"
#include "collision/response/embedded_mesh.h"
#include "data/core/errors.h"
#include "gnn/model/make_cloth.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/test_meshes.h"

namespace cloth::skin_blend_world_test {

using namespace cloth::test;

namespace {

constexpr double h = 1.0 / 60.0;
constexpr double floats = 1e-6;  // m: Bullet's time step has single precision

/// A sheet that hangs from two corners; its skin is the level sheet, which moves along x.
class FadingSheet : public testing::Test {
 protected:
    FadingSheet()
        : solver([](const Garment& garment) { return make_cloth(garment); }), world(&solver) {
        cloth = world.add(patch(world.info(), {0, 0, 0}, 9, 1 + 2));
        solver.attach(cloth, Fabric::soft_cotton());
        start = nodePositions(*cloth);
    }
    Points skin(int at) const {
        Points x = start;
        x.col(0).array() += 0.001 * at;
        return x;
    }
    void step(int count) {
        for (int k = 0; k < count; ++k, ++frame) {
            solver.setGoals(cloth, {skin(frame), skin(frame + 1), {}, {}}, h);
            world.step(h);
        }
    }
    double distance(const Points& a, const Points& b) const {
        return (a - b).rowwise().norm().maxCoeff();
    }

    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* cloth = nullptr;
    Points start;
    int frame = 0;
};

}  // namespace

TEST_F(FadingSheet, ItFadesInTheTimeThatWasSaidAndBack) {
    step(30);
    EXPECT_EQ(solver.shownPositions(cloth), nodePositions(*cloth));
    solver.fadeToSkin(cloth, 1.0, 0.5);
    for (int k = 1; k <= 30; ++k) {
        step(1);
        const double weight = k / 30.0;
        const Points expected = (1.0 - weight) * nodePositions(*cloth) + weight * skin(frame);
        ASSERT_LT(distance(solver.shownPositions(cloth), expected), floats) << k;
    }
    EXPECT_LT(distance(solver.shownPositions(cloth), skin(frame)), 1e-9) << "skinned";
    EXPECT_GT(distance(nodePositions(*cloth), skin(frame)), 0.3) << "the cloth hangs all the same";
    solver.fadeToSkin(cloth, 0.0, 0.25);
    step(15);
    EXPECT_EQ(solver.shownPositions(cloth), nodePositions(*cloth));
}

TEST_F(FadingSheet, TheClothDoesNotFeelIt) {
    btGnnSoftBodySolver other([](const Garment& garment) { return make_cloth(garment); });
    World plain(&other);
    btSoftBody* const same = plain.add(patch(plain.info(), {0, 0, 0}, 9, 1 + 2));
    other.attach(same, Fabric::soft_cotton());
    solver.fadeToSkin(cloth, 1.0, 0.2);
    for (int k = 0; k < 40; ++k) {
        other.setGoals(same, {skin(k), skin(k + 1), {}, {}}, h);
        plain.step(h);
        step(1);
        ASSERT_EQ(nodePositions(*cloth), nodePositions(*same)) << k;
    }
}

TEST_F(FadingSheet, WhatFollowsItFollowsWhatIsShown) {
    TriMesh fine = square_mesh(20);
    fine.vertices.rowwise() -= Eigen::RowVector3d(0.5, 0.0, 0.5);
    const auto drawn = std::make_shared<EmbeddedMesh>(solver.garmentOf(cloth)->rest(), fine);
    solver.follow(cloth, drawn);
    solver.fadeToSkin(cloth, 0.7);
    step(20);
    Points expected;
    drawn->embedding().positions(solver.shownPositions(cloth), expected);
    EXPECT_LT(distance(drawn->vertices(), expected), 1e-9);
    EXPECT_GT(distance(solver.shownPositions(cloth), nodePositions(*cloth)), 0.05);
}

TEST_F(FadingSheet, WhatIsShownIsNotInsideABody) {
    btRigidBody* const ball = world.add(new btSphereShape(0.2f), {0, -0.15f, 0}, true);
    solver.fadeToSkin(cloth, 0.6);
    double shallowest = 0.0;
    for (int k = 0; k < 60; ++k) {
        ball->getWorldTransform().getOrigin().setX(0.1f * std::sin(0.1f * static_cast<float>(k)));
        step(1);
        const Vec3 centre = toVec3(ball->getWorldTransform().getOrigin());
        const VectorX shown =
            (solver.shownPositions(cloth).rowwise() - centre.transpose()).rowwise().norm();
        ASSERT_GE(shown.minCoeff(), 0.2 - 1e-6) << k;
        const Points mixed = 0.4 * nodePositions(*cloth) + 0.6 * skin(frame);
        shallowest = std::max(
            shallowest, 0.2 - (mixed.rowwise() - centre.transpose()).rowwise().norm().minCoeff());
    }
    EXPECT_GT(shallowest, 0.01) << "the mixture alone would be inside";
}

TEST_F(FadingSheet, ItGoesOnWhileTheClothSleeps) {
    cloth->m_cfg.kDP = 0.05f;
    solver.setGoals(cloth, SkinGoals::at(start));
    world.step(h, 60 * 15);
    ASSERT_EQ(solver.status().sleepingBodies, 1);
    solver.fadeToSkin(cloth, 1.0, 20.0);
    world.step(h, 60 * 10);
    ASSERT_EQ(solver.status().sleepingBodies, 1) << "it was woken, and rests again";
    EXPECT_LT(distance(solver.shownPositions(cloth), 0.5 * (nodePositions(*cloth) + start)), 1e-5);
    world.step(h, 60 * 10 + 1);
    EXPECT_LT(distance(solver.shownPositions(cloth), start), 1e-9);
}

TEST_F(FadingSheet, ItIsTeleportedWithItsBody) {
    step(20);
    solver.fadeToSkin(cloth, 0.5);
    step(1);
    const Points before = solver.shownPositions(cloth);
    solver.teleport(cloth, btTransform(btQuaternion::getIdentity(), {3, 1, 2}));
    const Points expected = before.rowwise() + Eigen::RowVector3d(3, 1, 2);
    EXPECT_LT(distance(solver.shownPositions(cloth), expected), 1e-5);
}

TEST_F(FadingSheet, WrongArgumentsAreRefused) {
    EXPECT_THROW(solver.fadeToSkin(nullptr, 1.0), ArgumentError);
    EXPECT_THROW(solver.shownPositions(nullptr), ArgumentError);
    for (const double wrong : {-0.1, 1.1, std::nan("")})
        EXPECT_THROW(solver.fadeToSkin(cloth, wrong), ArgumentError);
    for (const double wrong : {-1.0, 1e7, std::numeric_limits<double>::infinity()})
        EXPECT_THROW(solver.fadeToSkin(cloth, 1.0, wrong), ArgumentError);
    step(1);
    EXPECT_EQ(solver.shownPositions(cloth), nodePositions(*cloth)) << "nothing was changed";
}

}  // namespace cloth::skin_blend_world_test
