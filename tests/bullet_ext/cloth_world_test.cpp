// The whole chain: a Bullet world whose cloth is stepped by the physical solver.

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bullet_ext/garmentSoftBody.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"
#include "tests/test_meshes.h"

namespace cloth::cloth_world_test {

using namespace cloth::test;

namespace {

/// A level floor of 4 m x 4 m at height 0 as a triangle mesh.
struct Floor {
    btTriangleMesh mesh;
    explicit Floor(double size = 1.0) {
        const TriMesh square = square_mesh(5);
        const auto corner = [&](Eigen::Index f, int c) {
            const Vec3 x = square.vertices.row(square.faces(f, c));
            return btVector3(static_cast<btScalar>(size * (4 * x.x() - 2)), 0,
                             static_cast<btScalar>(size * (4 * x.z() - 2)));
        };
        for (Eigen::Index f = 0; f < square.faces.rows(); ++f)
            mesh.addTriangle(corner(f, 0), corner(f, 1), corner(f, 2));
    }
};

double lowest(const btSoftBody& body) {
    double y = std::numeric_limits<double>::infinity();
    for (int i = 0; i < body.m_nodes.size(); ++i) y = std::min(y, node(body, i).y());
    return y;
}

double deepest_in_sphere(const btSoftBody& body, const Vec3& centre, double radius) {
    double depth = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < body.m_nodes.size(); ++i)
        depth = std::max(depth, radius - (node(body, i) - centre).norm());
    return depth;
}

double mean_stretch(const btSoftBody& body) {
    double sum = 0.0;
    for (int l = 0; l < body.m_links.size(); ++l) {
        const btSoftBody::Link& link = body.m_links[l];
        sum += static_cast<double>((link.m_n[0]->m_x - link.m_n[1]->m_x).length() / link.m_rl);
    }
    return sum / body.m_links.size();
}

}  // namespace

TEST(ClothWorld, PinnedPatchHangsAtEveryRate) {
    for (double fixed : {0.0, 1.0 / 30.0})
        for (double rate : {60.0, 240.0}) {
            btGnnSoftBodySolver solver(quasi_newton(fixed));
            World world(&solver);
            btSoftBody* cloth = world.add(patch(world.info(), {0, 2, 0}, 9, 1 + 2));
            cloth->m_cfg.kDP = static_cast<btScalar>(1.0 - std::pow(0.1, 1.0 / rate));
            world.step(1.0 / rate, static_cast<int>(2 * rate));
            EXPECT_EQ(node(*cloth, 0), Vec3(-0.5, 2, -0.5));
            EXPECT_LT(lowest(*cloth), 1.3) << fixed << " " << rate;
            EXPECT_GT(lowest(*cloth), 0.7) << fixed << " " << rate;
            EXPECT_NEAR(mean_stretch(*cloth), 1.0, 0.05);
            EXPECT_EQ(solver.status().failedSteps, 0);
            EXPECT_TRUE(solver.status().messages.empty());
        }
}

TEST(ClothWorld, PatchFallsOnASphereAndStaysOutside) {
    for (double fixed : {0.0, 1.0 / 30.0}) {
        btGnnSoftBodySolver solver(quasi_newton(fixed));
        World world(&solver);
        world.add(new btSphereShape(0.3f), {0, 0, 0});
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0.35f, 0}, 13));
        for (int i = 0; i < 40; ++i) {
            world.step(1.0 / 60.0);
            EXPECT_LT(deepest_in_sphere(*cloth, Vec3::Zero(), 0.3), 1e-3) << "step " << i;
        }
        EXPECT_GT(node(*cloth, 6 * 13 + 6).y(), 0.3);
        EXPECT_LT(lowest(*cloth), 0.1);
    }
}

TEST(ClothWorld, MovingSphereCarriesClothUp) {
    btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0));
    World world(&solver);
    btRigidBody* sphere = world.add(new btSphereShape(0.3f), {0, 0, 0}, true);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0.31f, 0}, 13));
    for (int i = 1; i <= 30; ++i) {
        btTransform t = sphere->getWorldTransform();
        t.setOrigin({0, 0.005f * static_cast<btScalar>(i), 0});
        sphere->setWorldTransform(t);
        world->stepSimulation(1.0f / 60, 4, 1.0f / 240);
        EXPECT_LT(deepest_in_sphere(*cloth, {0, 0.005 * i, 0}, 0.3), 4e-3) << "frame " << i;
    }
    EXPECT_GT(node(*cloth, 6 * 13 + 6).y(), 0.44);
}

TEST(ClothWorld, AnimatedMeshCarriesClothUp) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btRigidBody* handle = world.add(new btSphereShape(0.3f), {0, 0, 0}, true);
    const TriMesh ball = sphere_mesh(0.3, 20);
    const auto faces = std::make_shared<const Faces>(ball.faces);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0.31f, 0}, 13));
    Points now = ball.vertices;
    for (int i = 1; i <= 15; ++i) {
        Points next = ball.vertices;
        next.col(1).array() += 0.01 * i;
        solver.setAnimatedObstacle(handle, faces, now, next, 1.0 / 30.0);
        world->stepSimulation(1.0f / 30, 2, 1.0f / 60);
        now = next;
        EXPECT_LT(deepest_in_sphere(*cloth, {0, 0.01 * i, 0}, 0.3), 4e-3) << "frame " << i;
    }
    EXPECT_GT(node(*cloth, 6 * 13 + 6).y(), 0.44);
    solver.removeAnimatedObstacle(handle);
}

TEST(ClothWorld, EveryKindOfShapeHoldsCloth) {
    Floor floor;
    Floor half(0.5);
    std::vector<std::pair<btCollisionShape*, btVector3>> shapes = {
        {new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0}},
        {new btBoxShape({1, 0.2f, 1}), {0, -0.2f, 0}},
        {new btCylinderShape({1, 0.2f, 1}), {0, -0.2f, 0}},
        {new btBvhTriangleMeshShape(&floor.mesh, true), {0, 0, 0}},
    };
    std::vector<float> heights(9, 0.0f);
    auto* field =
        new btHeightfieldTerrainShape(3, 3, heights.data(), 1, -1, 1, 1, PHY_FLOAT, false);
    field->setLocalScaling({2, 1, 2});
    shapes.push_back({field, {0, 0, 0}});
    auto* gimpact = new btGImpactMeshShape(&floor.mesh);
    gimpact->updateBound();
    shapes.push_back({gimpact, {0, 0, 0}});
    btBvhTriangleMeshShape small(&half.mesh, true);
    shapes.push_back({new btScaledBvhTriangleMeshShape(&small, {2, 1, 2}), {0, 0, 0}});
    auto* compound = new btCompoundShape;
    btBoxShape slab({1, 0.1f, 1});
    compound->addChildShape(btTransform(btQuaternion::getIdentity(), {0, -0.1f, 0}), &slab);
    shapes.push_back({compound, {0, 0, 0}});
    auto* hull = new btConvexHullShape;
    for (int corner = 0; corner < 8; ++corner)
        hull->addPoint(
            {corner & 1 ? 1.0f : -1.0f, corner & 2 ? 0.1f : -0.1f, corner & 4 ? 1.0f : -1.0f});
    shapes.push_back({hull, {0, -0.1f, 0}});
    for (const auto& [shape, position] : shapes) {
        btGnnSoftBodySolver solver(quasi_newton());
        World world(&solver);
        world.add(shape, position);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0.03f, 0}, 7));
        world.step(1.0 / 60.0, 40);
        EXPECT_GT(lowest(*cloth), -1e-3) << shape->getName();
        EXPECT_LT(lowest(*cloth), 0.02) << shape->getName();
    }
}

TEST(ClothWorld, TwoRunsAreTheSameBits) {
    std::vector<btVector3> results[2];
    for (auto& result : results) {
        btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0));
        World world(&solver);
        world.add(new btSphereShape(0.3f), {0, 0, 0});
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0.32f, 0}, 9, 1));
        world.step(1.0 / 60.0, 30);
        for (int i = 0; i < cloth->m_nodes.size(); ++i) result.push_back(cloth->m_nodes[i].m_x);
    }
    for (size_t i = 0; i < results[0].size(); ++i)
        for (int c = 0; c < 3; ++c) ASSERT_EQ(results[0][i][c], results[1][i][c]);
}

}  // namespace cloth::cloth_world_test
