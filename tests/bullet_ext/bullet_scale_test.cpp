// Cloth as Bullet's demos make it, metres wide and of kilograms, hangs, bends and slides with our
// solver as it does with Bullet's: nothing but the solver is another.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "gnn/model/make_cloth.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::bullet_scale_test {

using namespace cloth::test;

namespace {

StepperFactory quasi_newton() {
    return [](const Garment& garment) { return make_cloth(garment); };
}

/// A level sheet of half the given sizes (m) around `centre`.
btSoftBody* sheet(btSoftBodyWorldInfo& info, const btVector3& centre, btScalar x, btScalar z,
                  int columns, int rows, int pins) {
    return btSoftBodyHelpers::CreatePatch(
        info, centre + btVector3(-x, 0, -z), centre + btVector3(x, 0, -z),
        centre + btVector3(-x, 0, z), centre + btVector3(x, 0, z), columns, rows, pins, true);
}

/// A sheet that hangs, of the sizes and settings of a demo of Bullet.
struct Hanging {
    const char* name;
    std::function<btSoftBody*(World&)> make;
};

const std::vector<Hanging>& hanging_sheets() {
    static const std::vector<Hanging> all = {
        {"two corners, 4 m",  // SimpleCloth
         [](World& world) {
             btSoftBody* body = sheet(world.info(), {0, 5, 2}, 2, 2, 31, 31, 1 + 2);
             body->getCollisionShape()->setMargin(0.001f);
             body->generateBendingConstraints(2, body->appendMaterial());
             body->setTotalMass(10);
             body->m_cfg.piterations = 5;
             body->m_cfg.kDP = 0.005f;
             return body;
         }},
        {"four corners, 16 m",  // Cloth
         [](World& world) {
             btSoftBody* body = sheet(world.info(), {0, 0, 0}, 8, 8, 31, 31, 1 + 2 + 4 + 8);
             body->getCollisionShape()->setMargin(0.5f);
             btSoftBody::Material* bending = body->appendMaterial();
             bending->m_kLST = 0.4f;
             body->generateBendingConstraints(2, bending);
             body->setTotalMass(150);
             return body;
         }},
        {"a board of 20 kg at two corners, 8 m",  // ClothAttach, the board held
         [](World& world) {
             btSoftBody* body = sheet(world.info(), {0, 6, 0}, 4, 4, 9, 9, 4 + 8);
             btRigidBody* board =
                 world.add(new btBoxShape({4, 1, 3}), {0, 6, -7.5f}, /*kinematic=*/true);
             body->appendAnchor(0, board);
             body->appendAnchor(8, board);
             return body;
         }},
        {"flag, 10 m by 20 m, in the wind",  // Aero2
         [](World& world) {
             btSoftBody* body = sheet(world.info(), {0, 0, -5}, 5, 10, 10, 30, 1 + 2);
             body->getCollisionShape()->setMargin(0.5f);
             btSoftBody::Material* bending = body->appendMaterial();
             bending->m_kLST = 0.0004f;
             body->generateBendingConstraints(2, bending);
             body->m_cfg.kLF = 0.05f;
             body->m_cfg.kDG = 0.01f;
             body->m_cfg.piterations = 2;
             body->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSidedLiftDrag;
             body->setWindVelocity({4, -12, -25});
             body->rotate(btQuaternion(btVector3(1, 0, 0), SIMD_PI / 2));
             body->setTotalMass(2);
             btSoftBodyHelpers::ReoptimizeLinkOrder(body);
             return body;
         }},
        {"four corners, 12 m, one iteration",  // Cutting1
         [](World& world) {
             btSoftBody* body = sheet(world.info(), {0, 2, 0}, 6, 6, 16, 16, 1 + 2 + 4 + 8);
             body->m_cfg.piterations = 1;
             return body;
         }}};
    return all;
}

std::vector<double> edge_lengths(const btSoftBody& body) {
    std::vector<double> lengths;
    for (int l = 0; l < body.m_links.size(); ++l) {
        const btSoftBody::Link& link = body.m_links[l];
        if (!link.m_bbending) lengths.push_back((link.m_n[0]->m_x - link.m_n[1]->m_x).length());
    }
    return lengths;
}

struct Stretch {
    double mean, most;
};

/// Of the links along edges after `seconds`.
Stretch stretch_of(const Hanging& hanging, btSoftBodySolver* solver, int seconds) {
    World world(solver);
    btSoftBody* body = world.add(hanging.make(world));
    const std::vector<double> rest = edge_lengths(*body);
    Stretch worst{0.0, 0.0};
    world.step(1.0 / 60.0, 60 * (seconds - 1));
    for (int i = 0; i < 6; ++i) {
        world.step(1.0 / 60.0, 10);
        const std::vector<double> now = edge_lengths(*body);
        Stretch stretch{0.0, 0.0};
        for (size_t l = 0; l < now.size(); ++l) {
            stretch.mean += (now[l] / rest[l] - 1.0) / static_cast<double>(now.size());
            stretch.most = std::max(stretch.most, now[l] / rest[l] - 1.0);
        }
        worst.mean = std::max(worst.mean, stretch.mean);
        worst.most = std::max(worst.most, stretch.most);
    }
    return worst;
}

/// How far a strip of edges of length a (m), clamped at one end, reaches out from there, over its
/// length of `edges` edges: 1 is straight, 0 hangs down.
double reach_of_strip(btScalar a, int edges, btScalar bending, btSoftBodySolver* solver) {
    World world(solver);
    const int columns = edges + 2, rows = 5;
    btSoftBody* strip =
        sheet(world.info(), {0, 0, 0}, btScalar(columns - 1) * a / 2, 2 * a, columns, rows, 0);
    btSoftBody::Material* material = strip->appendMaterial();
    material->m_kLST = bending;
    strip->generateBendingConstraints(2, material);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < 2; ++column) strip->setMass(row * columns + column, 0);
    strip->m_cfg.kDP = 0.02f;
    world.add(strip);
    world.step(1.0 / 60.0, 600);
    double sum = 0.0;
    for (int i = 0; i < 60; ++i) {
        world.step(1.0 / 60.0);
        const double clamp = node(*strip, 2 * columns + 1).x();
        sum += (node(*strip, 3 * columns - 1).x() - clamp) / (edges * static_cast<double>(a));
    }
    return sum / 60;
}

}  // namespace

TEST(BulletScale, HangingSheetsStretchNoMoreThanBullets) {
    for (const Hanging& hanging : hanging_sheets()) {
        SCOPED_TRACE(hanging.name);
        btGnnSoftBodySolver solver(quasi_newton());
        const Stretch bullets = stretch_of(hanging, nullptr, 10);
        const Stretch ours = stretch_of(hanging, &solver, 10);
        EXPECT_GT(bullets.mean, 0.0);
        EXPECT_LT(ours.mean, bullets.mean + 0.05);
        EXPECT_LT(ours.most, bullets.most + 0.05);
        EXPECT_EQ(solver.status().clothBodies, 1);
        EXPECT_EQ(solver.status().failedSteps, 0);
        EXPECT_TRUE(solver.status().messages.empty());
    }
}

// Strips of three edges: longer ones hang down with any stiffness. Bullet's own bends by how far a
// correction gets in an iteration, ours by a stiffness: shapes agree, not figures.
TEST(BulletScale, StripsReachOutAsFarAsBullets) {
    for (const btScalar edge : {0.02f, 0.1f, 0.5f}) {
        double reach[2];
        for (const bool stiff : {false, true}) {
            const btScalar bending = stiff ? 1.0f : 0.1f;
            SCOPED_TRACE(std::to_string(edge) + " m, " + std::to_string(bending));
            btGnnSoftBodySolver solver(quasi_newton());
            const double bullets = reach_of_strip(edge, 3, bending, nullptr);
            reach[stiff] = reach_of_strip(edge, 3, bending, &solver);
            EXPECT_NEAR(reach[stiff], bullets, 0.05 + 0.5 * bullets);
        }
        EXPECT_GT(reach[1], 1.3 * reach[0]) << edge;
    }
}

TEST(BulletScale, TwiceTheMassMovesTheSame) {
    Points shapes[2];
    for (int heavy = 0; heavy < 2; ++heavy) {
        btGnnSoftBodySolver solver(quasi_newton());
        World world(&solver);
        btSoftBody* body = sheet(world.info(), {0, 0, 0}, 2, 2, 9, 9, 1 + 2);
        body->setTotalMass(heavy ? 20.0f : 10.0f);
        world.add(body);
        world.step(1.0 / 60.0, 60);
        shapes[heavy].resize(81, 3);
        for (int i = 0; i < 81; ++i) shapes[heavy].row(i) = node(*body, i);
    }
    EXPECT_EQ(shapes[0], shapes[1]);
}

}  // namespace cloth::bullet_scale_test
