// Cloth bodies that meet in a Bullet world, whatever steppers they have.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "bullet_ext/softBodyGarment.h"
#include "collision/self/self_tangles.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"
#include "tests/test_meshes.h"

namespace cloth::cloth_contacts_test {

using namespace cloth::test;

namespace {

constexpr int kSoftContact = btSoftBody::fCollision::VF_SS;

btSoftBody* asking(btSoftBody* body, btScalar friction = 0.2f) {
    body->setTotalMass(0.2f);
    body->m_cfg.collisions |= kSoftContact;
    body->m_cfg.kDF = friction;
    return body;
}

/// A level patch of n x n nodes with edges of half a metre, which lies on a patch() with room
/// around it.
btSoftBody* half_patch(btSoftBodyWorldInfo& info, const btVector3& centre, int n) {
    const btScalar r = 0.25f;
    return btSoftBodyHelpers::CreatePatch(
        info, centre + btVector3(-r, 0, -r), centre + btVector3(r, 0, -r),
        centre + btVector3(-r, 0, r), centre + btVector3(r, 0, r), n, n, 0, true);
}

/// The cloth of a world, all together.
struct Whole {
    btGnnSoftBodySolver& solver;
    std::vector<btSoftBody*> bodies;

    VectorX masses(const btSoftBody& body) const {
        const Garment& garment = *solver.garmentOf(&body);
        return massRatio(body, garment) * garment.masses();
    }
    /// Of motion, height and fabric (J).
    double energy() const {
        double sum = 0.0;
        for (const btSoftBody* body : bodies) {
            const VectorX mass = masses(*body);
            const Points x = nodePositions(*body);
            sum += massRatio(*body, *solver.garmentOf(body)) *
                   solver.stepperOf(body)->internal_energy(x).value_or(0.0);
            sum -= mass.dot(x * toVec3(body->m_worldInfo->m_gravity));
            for (int i = 0; i < body->m_nodes.size(); ++i)
                sum += 0.5 * mass[i] * toVec3(body->m_nodes[i].m_v).squaredNorm();
        }
        return sum;
    }
    Vec3 momentum() const {
        Vec3 sum = Vec3::Zero();
        for (const btSoftBody* body : bodies) {
            const VectorX mass = masses(*body);
            for (int i = 0; i < body->m_nodes.size(); ++i)
                sum += mass[i] * toVec3(body->m_nodes[i].m_v);
        }
        return sum;
    }
    /// Edges of one body that pass through a face of another one.
    int tangles() const {
        Eigen::Index vertices = 0, faces = 0;
        for (const btSoftBody* body : bodies) {
            vertices += body->m_nodes.size();
            faces += body->m_faces.size();
        }
        TriMesh all{Points(vertices, 3), Faces(faces, 3)};
        std::vector<int> part;
        Points x(vertices, 3);
        Eigen::Index vertex = 0, face = 0;
        for (const btSoftBody* body : bodies) {
            const Points& rest = solver.garmentOf(body)->rest().vertices;
            all.vertices.middleRows(vertex, rest.rows()) = rest;
            all.faces.middleRows(face, body->m_faces.size()) =
                faceNodes(*body).array() + static_cast<int>(vertex);
            x.middleRows(vertex, rest.rows()) = nodePositions(*body);
            part.insert(part.end(), size_t(rest.rows()), int(vertex));
            vertex += rest.rows();
            face += body->m_faces.size();
        }
        const Garment garment("all", std::move(all), Fabric::soft_cotton());
        int count = 0;
        SelfTangles tangles(garment);
        for (const Tangle& tangle : tangles.find(x))
            count += part[size_t(garment.edges()[size_t(tangle.edge)][0])] !=
                     part[size_t(garment.rest().faces(tangle.face, 0))];
        return count;
    }
};

double lowest(const btSoftBody& body) {
    return nodePositions(body).col(1).minCoeff();
}

double mean_height(const btSoftBody& body) {
    return nodePositions(body).col(1).mean();
}

double mean_x(const btSoftBody& body) {
    return nodePositions(body).col(0).mean();
}

/// How high a place is above a sheet that is nearly level (m).
double height_above(const btSoftBody& sheet, const Vec3& place) {
    const Points x = nodePositions(sheet);
    const Faces faces = faceNodes(sheet);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        Eigen::Matrix3d corners;  // of the face, seen from above
        for (int k = 0; k < 3; ++k) corners.col(k) << x(faces(f, k), 0), x(faces(f, k), 2), 1.0;
        const Vec3 weights = corners.inverse() * Vec3(place.x(), place.z(), 1.0);
        if (weights.minCoeff() < 0.0) continue;
        double height = place.y();
        for (int k = 0; k < 3; ++k) height -= weights[k] * x(faces(f, k), 1);
        return height;
    }
    return -std::numeric_limits<double>::infinity();
}

/// A sheet falls on one that hangs at its corners.
/// @return how high its middle ends above the other one, or above that one's middle (m)
double fall(double h, double seconds, bool asks, const btGnnSolverSettings& settings,
            btGnnSolverStatus* status = nullptr) {
    btGnnSoftBodySolver solver(quasi_newton(), settings);
    World world(&solver);
    btSoftBody* below = world.add(patch(world.info(), {0, 0, 0}, 11, 1 + 2 + 4 + 8));
    btSoftBody* above = world.add(half_patch(world.info(), {0.05f, 0.15f, 0.02f}, 9));
    asking(below);
    asking(above);
    if (!asks) above->m_cfg.collisions &= ~kSoftContact;
    const Whole whole{solver, {below, above}};
    int most = 0;
    for (int i = 0; i < std::lround(seconds / h); ++i) {
        world.step(h);
        most = std::max(most, whole.tangles());
    }
    if (status) *status = solver.status();
    if (asks && settings.layerThickness > 0.0) {
        EXPECT_EQ(most, 0) << "at steps of " << h;
    }
    const Vec3 middle = node(*above, 40);
    return asks && settings.layerThickness > 0.0 ? height_above(*below, middle)
                                                 : middle.y() - node(*below, 60).y();
}

}  // namespace

TEST(ClothContacts, ASheetIsCaughtByAnother) {
    for (const double h : {1.0 / 60, 1.0 / 240}) {
        btGnnSolverStatus status;
        const double gap = fall(h, 1.5, true, soft_cotton(), &status);
        EXPECT_GT(gap, 0.0) << h;
        EXPECT_LT(gap, 0.1) << h;
        EXPECT_GT(status.touchingPairs, 0);
        EXPECT_EQ(status.passedPairs, 0);
        EXPECT_TRUE(status.messages.empty()) << status.messages.front().text;
    }
}

TEST(ClothContacts, OnlyWhereBothAskAndTheSolverMay) {
    EXPECT_LT(fall(1.0 / 60, 1.0, false, soft_cotton()), -1.0);
    btGnnSolverSettings settings = soft_cotton();
    settings.layerThickness = 0.0;
    btGnnSolverStatus status;
    EXPECT_LT(fall(1.0 / 60, 1.0, true, settings, &status), -1.0);
    ASSERT_EQ(status.messages.size(), 1u);
    EXPECT_NE(status.messages[0].text.find("layerThickness"), std::string::npos);
}

TEST(ClothContacts, BulletsFiltersCount) {
    btGnnSoftBodySolver solver(quasi_newton(), soft_cotton());
    World world(&solver);
    btSoftBody* below = world.add(patch(world.info(), {0, 0, 0}, 7, 1 + 2 + 4 + 8));
    btSoftBody* above = world.add(patch(world.info(), {0, 0.1f, 0}, 7));
    asking(below);
    asking(above)->setIgnoreCollisionCheck(below, true);
    world.step(1.0 / 60, 60);
    EXPECT_LT(mean_height(*above), mean_height(*below) - 0.5);
}

TEST(ClothContacts, SteppersThatDifferMeet) {
    for (const bool any : {true, false}) {
        btGnnSoftBodySolver solver(quasi_newton(), soft_cotton());
        World world(&solver);
        btSoftBody* below = world.add(patch(world.info(), {0, 0, 0}, 9, 1 + 2 + 4 + 8));
        btSoftBody* above = world.add(patch(world.info(), {0.03f, 0.1f, 0}, 9));
        solver.attach(asking(above), Fabric::soft_cotton(), [=](const Garment& garment) {
            return std::make_unique<Ticking>(quasi_newton()(garment), 1.0 / 30, any);
        });
        asking(below);
        const Whole whole{solver, {below, above}};
        int most = 0;
        for (int i = 0; i < 90; ++i) {
            world.step(1.0 / 60);
            if (any) most = std::max(most, whole.tangles());
        }
        EXPECT_EQ(most, 0);
        double sum = 0.0;  // of the nodes above the other sheet
        int count = 0;
        for (int i = 0; i < above->m_nodes.size(); ++i) {
            const double height = height_above(*below, node(*above, i));
            if (std::isinf(height)) continue;
            sum += height;
            ++count;
        }
        EXPECT_GT(sum / count, -0.01) << any;
    }
}

TEST(ClothContacts, LayersOnATableRestAndSleepTogetherAndWake) {
    btGnnSoftBodySolver solver(quasi_newton(), soft_cotton());
    World world(&solver);
    world.add(new btBoxShape({1, 0.5f, 1}), {0, -0.5f, 0});
    std::vector<btSoftBody*> sheets;
    for (int k = 0; k < 3; ++k)
        sheets.push_back(asking(world.add(
            patch(world.info(), {0.02f * float(k), 0.01f + 0.02f * float(k), 0}, 7 + k))));
    for (int i = 0; i < 60 * 12 && solver.status().sleepingBodies < 3; ++i) world.step(1.0 / 60);
    EXPECT_EQ(solver.status().sleepingBodies, 3);
    for (size_t k = 0; k + 1 < sheets.size(); ++k)
        EXPECT_GT(mean_height(*sheets[k + 1]) - mean_height(*sheets[k]), 1e-3) << k;
    EXPECT_GT(lowest(*sheets[0]), -1e-3);
    EXPECT_LT(mean_height(*sheets[2]), 0.02);
    EXPECT_EQ((Whole{solver, sheets}.tangles()), 0);
    btSoftBody* fourth = asking(world.add(patch(world.info(), {0, 0.3f, 0}, 8)));
    int sleeping = 3;
    for (int i = 0; i < 60; ++i) {
        world.step(1.0 / 60);
        sleeping = std::min(sleeping, solver.status().sleepingBodies);
    }
    EXPECT_EQ(sleeping, 0) << "what falls on them wakes them";
    EXPECT_GT(mean_height(*fourth), mean_height(*sheets[2]));
    EXPECT_LT(mean_height(*fourth), 0.03);
}

TEST(ClothContacts, FrictionHoldsWhatItShouldAtAnyTimeStep) {
    for (const double h : {1.0 / 60, 1.0 / 240}) {
        for (const float friction : {0.05f, 1.0f}) {
            btGnnSoftBodySolver solver(quasi_newton(), soft_cotton());
            World world(&solver);
            world.info().m_gravity = {2.5f, -9.4f, 0};  // a slope of 0.27
            btSoftBody* below = asking(world.add(patch(world.info(), {0, 0, 0}, 9)), friction);
            for (int i = 0; i < below->m_nodes.size(); ++i) below->setMass(i, 0);
            btSoftBody* above = world.add(half_patch(world.info(), {-0.1f, 0.004f, 0}, 5));
            asking(above, friction);
            const double before = mean_x(*above);
            world.step(h, int(std::lround(0.3 / h)));
            const double way = mean_x(*above) - before;
            // Velocities first, then positions: a step more than half the square.
            const double slides = 0.5 * 0.3 * (0.3 + h) * (2.5 - 9.4 * double(friction));
            EXPECT_NEAR(way, std::max(0.0, slides), 3e-3) << h << ", " << friction;
            EXPECT_GT(lowest(*above), 0.0);
        }
    }
}

TEST(ClothContacts, WhatLiesOnTheUpperSheetIsBorneByTheLowerOne) {
    for (const float off : {0.0f, 1e-4f, 2e-4f}) {  // m: what swings, does not rest by chance
        btGnnSoftBodySolver solver(quasi_newton(), soft_cotton());
        World world(&solver);
        btSoftBody* below = asking(world.add(patch(world.info(), {0, 0, 0}, 11, 1 + 2 + 4 + 8)));
        btSoftBody* above = asking(world.add(half_patch(world.info(), {0, 0.02f, 0}, 9)));
        btRigidBody* ball = world.add(new btSphereShape(0.08f), {off, 0.15f, 0}, false, 0.1f);
        ball->setActivationState(DISABLE_DEACTIVATION);
        const Whole whole{solver, {below, above}};
        int most = 0;
        std::vector<Vec3> places;
        const auto centre = [&] { return toVec3(ball->getWorldTransform().getOrigin()); };
        for (int i = 0; i < 60 * 8; ++i) {
            world.step(1.0 / 60);
            places.push_back(centre());
            most = std::max(most, whole.tangles());
        }
        const auto mean = [&](int second) {
            Vec3 sum = Vec3::Zero();
            for (size_t i = 0; i < 60; ++i) sum += places[60 * size_t(second) + i];
            return Vec3(sum / 60.0);
        };
        EXPECT_EQ(most, 0);
        const auto nearest = [&](const btSoftBody& body) {
            const Points x = nodePositions(body);
            return (x.rowwise() - centre().transpose()).rowwise().norm().minCoeff();
        };
        EXPECT_NEAR(nearest(*above), 0.08, 0.01) << "the ball lies on the upper sheet";
        EXPECT_GT(nearest(*below), 0.079);
        EXPECT_GT(centre().y(), -0.4) << "the corners hold it";
        EXPECT_LT((centre() - places[60 * 7 - 1]).norm(), 0.01) << "it rests";
        EXPECT_LT((mean(7) - mean(6)).norm(), 0.01);
        for (size_t i = 60 * 7; i < places.size(); ++i)
            EXPECT_LT((places[i] - mean(7)).norm(), 0.025) << "of step " << i;
    }
}

/// Sheets that are thrown at each other in empty space.
TEST(ClothContacts, WhateverMeetsKeepsItsMomentumAndMakesNoEnergy) {
    int met = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        std::mt19937 random(seed);
        btGnnSoftBodySolver solver(quasi_newton(), soft_cotton());
        World world(&solver);
        world.info().m_gravity = {0, 0, 0};
        std::vector<btSoftBody*> sheets;
        for (int k = 0; k < 3; ++k) {
            const float side = float(k - 1);
            btSoftBody* sheet = world.add(patch(world.info(), {0, 0, 0}, 6 + k));
            asking(sheet, float(uniform(random, 0.0, 1.0)))->setTotalMass(0.1f + 0.1f * float(k));
            const Vec3 axis = random_point(random, 1.0).normalized();
            sheet->rotate(btQuaternion(toBullet(axis), float(uniform(random, 0.0, 0.4))));
            sheet->translate({float(uniform(random, -0.2, 0.2)), 0.45f * side, 0});
            sheet->addVelocity(
                {float(uniform(random, -1.0, 1.0)), -side * float(uniform(random, 0.5, 3.0)), 0});
            sheets.push_back(sheet);
        }
        const Whole whole{solver, sheets};
        const double h = seed % 2 == 0 ? 1.0 / 60 : 1.0 / 240;
        world.step(h);
        const double energy = whole.energy();
        const Vec3 momentum = whole.momentum();
        int tangles = 0, touching = 0;
        double most = energy, drift = 0.0;
        for (int i = 0; i < 0.8 / h; ++i) {
            world.step(h);
            most = std::max(most, whole.energy());
            drift = std::max(drift, (whole.momentum() - momentum).norm());
            tangles = std::max(tangles, whole.tangles());
            touching += solver.status().touchingPairs;
        }
        met += touching > 0;
        EXPECT_EQ(tangles, 0) << seed;
        EXPECT_LT(most, energy * 1.001) << seed;
        EXPECT_LT(drift, 1e-3 * energy) << seed;  // kg m/s; quasi-Newton steps keep it nearly
        EXPECT_EQ(solver.status().passedPairs, 0) << seed;
    }
    EXPECT_GE(met, 6);
}

/// As Bullet's Collide3, in all sizes: its own materials or soft cotton, and small steps, as
/// make_cloth() takes them.
TEST(ClothContacts, WhatFallsOnANetMakesNoEnergy) {
    int met = 0;
    for (unsigned seed = 0; seed < 45; ++seed) {
        std::mt19937 random(seed);
        const bool soft = seed % 3 == 0;
        btGnnSoftBodySolver solver(
            [](const Garment& garment) { return std::make_unique<ClothStepper>(garment); },
            soft ? soft_cotton() : btGnnSolverSettings{});
        World world(&solver);
        const double half = std::exp(uniform(random, std::log(0.3), std::log(8.0)));
        const auto patch = [&](double side, const Vec3& at, int n, int pins) {
            const auto corner = [&](double x, double z) {
                return toBullet(Vec3(at + Vec3(x * side, 0, z * side)));
            };
            btSoftBody* sheet =
                btSoftBodyHelpers::CreatePatch(world.info(), corner(-1, -1), corner(1, -1),
                                               corner(-1, 1), corner(1, 1), n, n, pins, true);
            sheet->m_cfg.collisions |= kSoftContact;
            sheet->m_cfg.kDF = float(uniform(random, 0.0, 1.0));
            sheet->setTotalMass(float(std::exp(uniform(random, std::log(0.05), std::log(200.0)))));
            return world.add(sheet);
        };
        const int n = 7 + int(random() % 8);
        btSoftBody* net = patch(half, Vec3::Zero(), n, 1 + 2 + 4 + 8);
        btSoftBody* sheet = patch(uniform(random, 0.3, 0.6) * half,
                                  half * Vec3(uniform(random, -0.6, 0.6), uniform(random, 0.1, 1.0),
                                              uniform(random, -0.6, 0.6)),
                                  4 + int(random() % 6), 0);
        const Whole whole{solver, {net, sheet}};
        constexpr double kRates[] = {60, 120, 240};
        const double rate = kRates[random() % 3];
        world.step(1.0 / rate);
        const double weight = 9.81 * (whole.masses(*net).sum() + whole.masses(*sheet).sum());
        const double scale = 2.0 * half * weight;
        double least = whole.energy(), rise = 0.0;
        int touching = 0, tangles = 0;
        for (int i = 0; i < 2.0 * rate; ++i) {
            world.step(1.0 / rate);
            const double energy = whole.energy();
            rise = std::max(rise, energy - least);
            least = std::min(least, energy);
            touching += solver.status().touchingPairs;
            tangles = std::max(tangles, whole.tangles());
        }
        met += touching > 0;
        EXPECT_EQ(tangles, 0) << seed;
        EXPECT_LT(rise, 1e-3 * scale + 0.013 * weight) << seed << ": lifts all by 13 mm";
    }
    EXPECT_GE(met, 38);
}

TEST(ClothContacts, BulletsClothIsPassedThroughWithAMessage) {
    btGnnSoftBodySolver solver(quasi_newton(), soft_cotton());
    World world(&solver);
    btSoftBody* below = asking(world.add(patch(world.info(), {0, 0, 0}, 7, 1 + 2 + 4 + 8)));
    asking(world.add(patch(world.info(), {0, 0.1f, 0}, 7)));
    solver.detach(below);
    world.step(1.0 / 60, 30);
    ASSERT_EQ(solver.status().messages.size(), 1u);
    EXPECT_NE(solver.status().messages[0].text.find("but cloth passes through soft bodies"),
              std::string::npos);
}

}  // namespace cloth::cloth_contacts_test
