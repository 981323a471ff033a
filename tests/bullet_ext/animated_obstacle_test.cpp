// Animated meshes as games give them: late, twice, with gaps, with new arrays in every frame.

#include <gtest/gtest.h>

#include "bullet_ext/animatedObstacle.h"
#include "collision/proximity/obstacle_trees.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"
#include "tests/test_meshes.h"

namespace cloth::animated_obstacle_test {

using namespace cloth::test;

namespace {

constexpr double h = 1.0 / 64.0;

const std::shared_ptr<const Faces>& ball_faces() {
    static const auto faces = std::make_shared<const Faces>(icosphere(1).faces);
    return faces;
}

/// A ball of 10 cm around x.
Points ball(double x) {
    Points points = 0.1 * icosphere(1).vertices;
    points.col(0).array() += x;
    return points;
}

/// Where a ball is, by its mean.
double place(const Points& points) {
    return points.col(0).mean();
}

struct Mover {
    AnimatedObstacle obstacle;
    std::vector<AnimatedObstacle::Box> placed = {};

    void give(double from, double to, double duration = h) {
        obstacle.give({ball_faces(), ball(from), ball(to), duration}, true);
    }
    void step(double dt = h) {
        obstacle.beginStep(dt, true, placed);
        placed.clear();
    }
    void expect(double from, double to, double dt = h) const {
        EXPECT_NEAR(place(obstacle.at(0.0)), from, 1e-12);
        EXPECT_NEAR(place(obstacle.at(dt)), to, 1e-12);
    }
    bool jumpsFromOrigin() const {
        return obstacle.jumpsFrom(Vec3::Constant(-0.1), Vec3::Constant(0.1));
    }
};

/// A sheet over a ball that is an animated mesh.
struct Scene {
    std::shared_ptr<FreeFall::Log> log = std::make_shared<FreeFall::Log>();
    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* cloth;
    btRigidBody* handle;

    explicit Scene(const StepperFactory& factory = nullptr)
        : solver(factory ? factory : free_fall(log)), world(&solver) {
        world.info().m_gravity.setZero();
        cloth = world.add(patch(world.info(), {0, 0.11f, 0}));
        handle = world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
        handle->setUserIndex(7);
    }
    void give(double from, double to, double duration = h) {
        solver.setAnimatedObstacle(handle, ball_faces(), ball(from), ball(to), duration);
    }
    const Obstacle& obstacle() const { return log->boundaries.back().obstacles.at(0); }
    const std::vector<btGnnSolverMessage>& messages() const { return solver.status().messages; }
    void expect_one_message(const char* part) const {
        ASSERT_EQ(messages().size(), 1u);
        EXPECT_EQ(messages()[0].count, 1);
        for (const char* each : {"animated obstacle 7 at ", part, "Remedy: "})
            EXPECT_NE(messages()[0].text.find(each), std::string::npos) << messages()[0].text;
    }
};

}  // namespace

TEST(AnimatedObstacle, WithoutGapsHasTheBitsOfWhatIsGiven) {
    Mover mover;
    for (int i = 0; i < 3; ++i) {
        mover.give(0.01 * i, 0.01 * (i + 1));
        mover.step();
        EXPECT_EQ(mover.obstacle.at(0.0), ball(0.01 * i));
        EXPECT_EQ(mover.obstacle.at(h), ball(0.01 * (i + 1)));
        EXPECT_TRUE(mover.obstacle.moves());
    }
    // As of a program that skins in single precision.
    const Points near = ball(0.03).cast<float>().cast<double>();
    mover.obstacle.give({ball_faces(), near, ball(0.04), h}, true);
    mover.step();
    EXPECT_EQ(mover.obstacle.at(0.0), near);
}

TEST(AnimatedObstacle, GoesThroughAGapFromWhereItWas) {
    Mover mover;
    mover.give(0.0, 0.01);
    mover.step();
    for (int i = 1; i < 4; ++i) mover.step();
    mover.give(0.04, 0.05);
    mover.step();
    EXPECT_EQ(mover.obstacle.at(0.0), ball(0.01));
    EXPECT_EQ(mover.obstacle.at(h), ball(0.05));
    EXPECT_NEAR(place(mover.obstacle.at(h / 2)), 0.03, 1e-12);
    EXPECT_NEAR(place(mover.obstacle.at(2 * h)), 0.06, 1e-12) << "beyond x1 with what was given";
    mover.give(0.10, 0.12, 2 * h);  // also over several steps
    mover.step();
    mover.expect(0.05, 0.085);
    mover.step();
    mover.expect(0.085, 0.12);
    mover.step();
    mover.expect(0.12, 0.12);
    EXPECT_FALSE(mover.obstacle.isNear({0.3, -0.1, -0.1}, {0.35, 0.1, 0.1}));
    mover.give(0.55, 0.55);
    mover.step();
    EXPECT_TRUE(mover.obstacle.isNear({0.3, -0.1, -0.1}, {0.35, 0.1, 0.1})) << "it passes there";
}

TEST(AnimatedObstacle, ComesBackWhereItWentBeyondItsLastPose) {
    Mover mover;
    mover.give(0.0, 0.01, h / 1.5);
    mover.step();
    mover.expect(0.0, 0.015);
    mover.step();
    mover.expect(0.015, 0.01);
    EXPECT_TRUE(mover.obstacle.moves());
    mover.step();
    mover.expect(0.01, 0.01);
    EXPECT_FALSE(mover.obstacle.moves());
    EXPECT_EQ(mover.obstacle.at(h), ball(0.01));
}

TEST(AnimatedObstacle, JumpsOverGapsThatItDidNotGoThrough) {
    const auto at_start = [](Mover& mover, double x) {
        mover.give(0.0, 0.0);
        mover.step();
        mover.give(x, x);
    };
    Mover far;
    at_start(far, 0.6);
    far.step();
    far.expect(0.6, 0.6);
    Mover with_cloth;
    at_start(with_cloth, 0.3);
    with_cloth.placed = {{{0.25, 0.0, 0.0}, {0.35, 0.2, 0.2}}};
    with_cloth.step();
    with_cloth.expect(0.3, 0.3);
    Mover with_other_cloth;
    at_start(with_other_cloth, 0.3);
    with_other_cloth.placed = {{{5.25, 0.0, 0.0}, {5.35, 0.2, 0.2}}};
    with_other_cloth.step();
    with_other_cloth.expect(0.0, 0.3);
    Mover hidden;
    hidden.give(0.0, 0.0);
    hidden.step();
    hidden.obstacle.beginStep(h, false, {});
    hidden.give(0.3, 0.3);
    hidden.step();
    hidden.expect(0.3, 0.3);
    Mover other_mesh;
    other_mesh.give(0.0, 0.0);
    other_mesh.step();
    const Faces fewer = ball_faces()->topRows(70);
    other_mesh.obstacle.give({std::make_shared<const Faces>(fewer), ball(0.3), ball(0.3), h}, true);
    other_mesh.step();
    other_mesh.expect(0.3, 0.3);
}

TEST(AnimatedObstacle, WhatNoStepHasUsedIsNoPlaceToComeFrom) {
    Mover mover;
    mover.give(0.0, 0.0);
    mover.step();
    mover.give(9.0, 9.0);
    mover.give(9.0, 9.0);
    mover.step();
    EXPECT_TRUE(mover.jumpsFromOrigin()) << "a jump, given twice";
    mover.give(0.0, 0.0);
    mover.step();
    EXPECT_FALSE(mover.jumpsFromOrigin());
    mover.give(0.0, 0.6);  // fast motion, given twice
    mover.give(0.0, 0.6);
    mover.step();
    EXPECT_FALSE(mover.jumpsFromOrigin());
    mover.give(0.6, 0.0);
    mover.step();
    mover.give(9.0, 9.0);  // a mistake, mended
    mover.give(0.0, 0.01);
    mover.step();
    EXPECT_FALSE(mover.jumpsFromOrigin());
    mover.expect(0.0, 0.01);
    mover.give(0.3, 0.3);
    mover.give(0.02, 0.03);
    mover.step();
    mover.expect(0.01, 0.03);
}

TEST(AnimatedObstacle, StandsWhereItIsGivenAnew) {
    Mover mover;
    mover.give(0.0, 0.0);
    mover.step();
    EXPECT_TRUE(mover.obstacle.moves()) << "it is new";
    mover.give(0.0, 0.0);
    mover.step();
    EXPECT_FALSE(mover.obstacle.moves());
    mover.give(1e-5, 1e-5);
    mover.step();
    EXPECT_TRUE(mover.obstacle.moves()) << "it creeps";
    mover.give(1e-5, 0.01);
    mover.step();
    EXPECT_TRUE(mover.obstacle.moves());
}

TEST(AnimatedObstacle, ReachesItsPoseInAStepThatIsFarTooLong) {
    Mover mover;
    mover.give(0.0, 0.01, h / 4);
    mover.step();
    mover.expect(0.0, 0.04);
    for (int i = 0; i < 5; ++i) {
        mover.give(0.04 + 0.01 * i, 0.04 + 0.01 * (i + 1), 1e-5);
        mover.step();
        mover.expect(0.04 + 0.01 * i, 0.04 + 0.01 * (i + 1));
        EXPECT_EQ(mover.obstacle.takeTroubles().size(), i == 2 ? 1u : 0u);
    }
}

TEST(AnimatedObstacle, OneLongFrameIsNoTrouble) {
    Mover mover;
    for (int i = 0; i < 9; ++i) {
        mover.give(0.01 * i, 0.01 * (i + 1));
        const double dt = i == 4 ? 30 * h : h;
        mover.step(dt);
        mover.expect(0.01 * i, 0.01 * (i + 1), dt);
    }
    EXPECT_TRUE(mover.obstacle.takeTroubles().empty());
}

TEST(AnimatedObstacle, ShortDurationsAreTold) {
    Scene scene;
    for (int i = 0; i < 5; ++i) {
        scene.give(0.01 * i, 0.01 * (i + 1), 1e-5);
        scene.world.step(h);
        EXPECT_NEAR(place(scene.obstacle().x1), 0.01 * (i + 1), 1e-12);
    }
    scene.expect_one_message("its duration of 1e-05 s");
}

TEST(AnimatedObstacle, JumpThatIsGivenForEachGarmentIsTold) {
    Scene scene;
    for (const double to : {0.0, 9.0})
        for (int garment = 0; garment < 2; ++garment) {
            scene.give(to, to);
            if (garment == 1) scene.world.step(h);
        }
    ASSERT_EQ(scene.messages().size(), 1u);
    EXPECT_NE(scene.messages()[0].text.find("jumped"), std::string::npos);
}

TEST(AnimatedObstacle, NewPointersWithTheSameContentsAreTheSameMesh) {
    Scene scene(quasi_newton(0.0, 3));
    for (int i = 0; i < 12; ++i) {
        const auto faces = std::make_shared<const Faces>(*ball_faces());
        const auto limbs = std::make_shared<const std::vector<std::uint8_t>>(
            static_cast<size_t>(faces->rows()), std::uint8_t(3));
        scene.solver.setAnimatedObstacle(scene.handle, faces, ball(0.01 * i), ball(0.01 * (i + 1)),
                                         h, limbs);
        scene.world.step(h);
    }
    EXPECT_EQ(scene.solver.obstacleTrees().meshes(), 1);
    EXPECT_GT(scene.solver.obstacleTrees().counts().builds, 0);
    EXPECT_LE(scene.solver.obstacleTrees().counts().builds, 4);
    EXPECT_TRUE(scene.messages().empty());
}

TEST(AnimatedObstacle, FacesThatAreOthersInEachCallAreTold) {
    Scene scene;
    const auto give = [&](int count) {
        const Faces fewer = ball_faces()->topRows(count);
        scene.solver.setAnimatedObstacle(scene.handle, std::make_shared<const Faces>(fewer),
                                         ball(0.0), ball(0.0), h);
        scene.world.step(h);
    };
    for (int i = 0; i < 40; ++i) give(i / 4 % 2 == 0 ? 80 : 60);
    EXPECT_TRUE(scene.messages().empty()) << "levels of detail";
    for (int i = 0; i < 20; ++i) give(i % 2 == 0 ? 80 : 60);
    scene.expect_one_message("are others in each call");
}

TEST(AnimatedObstacle, TurnedFacesAreToldOnce) {
    const Faces& right = *ball_faces();
    Faces one_turned = right, all_turned = right, doubled(right.rows() + 1, 3);
    std::swap(one_turned(5, 1), one_turned(5, 2));
    all_turned.col(1).swap(all_turned.col(2));
    doubled << right, all_turned.row(9);
    const auto give = [](Scene& scene, const Faces& faces) {
        for (int i = 0; i < 3; ++i) {
            scene.solver.setAnimatedObstacle(scene.handle, std::make_shared<const Faces>(faces),
                                             ball(0.0), ball(0.0), h);
            scene.world.step(h);
        }
    };
    Scene clean;
    give(clean, right);
    give(clean, right.topRows(40));
    EXPECT_TRUE(clean.messages().empty());
    for (const auto& [faces, part] : {std::pair{one_turned, "face 5 looks to the other side"},
                                      std::pair{all_turned, "it is inside out"},
                                      std::pair{doubled, "face 80 stands there twice"}}) {
        Scene scene;
        give(scene, faces);
        scene.expect_one_message(part);
    }
}

TEST(AnimatedObstacle, SkinDoesNotSweepThroughClothThatWasPutElsewhere) {
    for (const bool with_cloth : {false, true}) {
        Scene scene;
        scene.give(0.0, 0.0);
        scene.world.step(h);
        if (with_cloth) {
            const btTransform motion(btQuaternion::getIdentity(), {0.3f, 0, 0});
            scene.solver.teleport(scene.cloth, motion);
        }
        scene.give(0.3, 0.3);
        scene.world.step(h);
        EXPECT_NEAR(place(scene.obstacle().x0), with_cloth ? 0.3 : 0.0, 1e-12);
        EXPECT_NEAR(place(scene.obstacle().x1), 0.3, 1e-12);
    }
    Scene late;  // dressed after the skin moved
    late.give(0.0, 0.0);
    late.world.step(h);
    late.world.add(patch(late.world.info(), {0, 0.12f, 0}));
    late.give(0.3, 0.3);
    late.world.step(h);
    EXPECT_NEAR(place(late.obstacle().x0), 0.3, 1e-12);
}

TEST(AnimatedObstacle, ClothSleepsOnSkinThatStandsAndWakesWhenItMoves) {
    Scene scene(quasi_newton(1.0 / 30.0, 3));
    scene.world.info().m_gravity = {0, -9.81f, 0};
    const TriMesh square = square_mesh(2);
    const auto floor = std::make_shared<const Faces>(square.faces);
    const auto at = [&](double y) {
        Points x = 4.0 * square.vertices;
        x.rowwise() += Eigen::RowVector3d(-2, y, -2);
        return x;
    };
    const auto sleeps = [&](double from, double to) {
        scene.solver.setAnimatedObstacle(scene.handle, floor, at(from), at(to), 1.0 / 60.0);
        scene.world.step(1.0 / 60.0);
        return scene.solver.status().sleepingBodies == 1;
    };
    const auto falls_asleep = [&](double y) {
        for (int i = 0; i < 60 * 6; ++i)
            if (sleeps(y, y)) return true;
        return false;
    };
    ASSERT_TRUE(falls_asleep(0.1));
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(sleeps(0.1, 0.1));
    EXPECT_FALSE(sleeps(0.1, 0.102));
    ASSERT_TRUE(falls_asleep(0.102));
    EXPECT_FALSE(sleeps(0.101, 0.101)) << "it moved between steps";
}

}  // namespace cloth::animated_obstacle_test
