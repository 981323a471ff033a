#include "collision/response/coulomb_contacts.h"

#include <gtest/gtest.h>

#include "tests/test_meshes.h"

namespace cloth::coulomb_contacts_test {
namespace {

using test::random_point;
using test::random_points;
using test::uniform;
using Contact = CoulombContacts::Contact;

constexpr double exact = 1e-12;

/// The point of vertex 0 over the ground, which vertex 1 (of no mobility) stands for.
Contact on_ground(double friction) {
    Contact contact{{0, 1, 0, 0}, {1.0, -1.0, 0.0, 0.0}, Vec3::UnitY()};
    contact.friction = friction;
    return contact;
}

Points moving(double along, double down) {
    Points v = Points::Zero(2, 3);
    v.row(0) << along, -down, 0.0;
    return v;
}

VectorX inverse_masses(double mass) {
    return Eigen::Vector2d(1.0 / mass, 0.0);
}

TEST(CoulombContacts, ApproachEndsAndTheCloserStaysUntouched) {
    CoulombContacts contacts(inverse_masses(0.5));
    contacts.add(on_ground(0.0));
    Points v = moving(0.3, 2.0);
    contacts.solve(10, 0.0, v);
    EXPECT_NEAR(v(0, 1), 0.0, exact);
    EXPECT_EQ(v(0, 0), 0.3);
    EXPECT_EQ(v.row(1).norm(), 0.0);
    EXPECT_NEAR(contacts.push(0), 0.5 * 2.0, exact);
}

TEST(CoulombContacts, WhatPartsIsLeftAlone) {
    CoulombContacts contacts(inverse_masses(1.0));
    contacts.add(on_ground(1.0));
    Points v = moving(0.3, -2.0);
    const Points before = v;
    contacts.solve(10, 0.0, v);
    EXPECT_EQ(v, before);
    EXPECT_EQ(contacts.push(0), 0.0);
}

TEST(CoulombContacts, FrictionSticksInsideItsConeAndSlidesOutside) {
    for (const double along : {0.5, 0.99, 1.01, 3.0}) {
        CoulombContacts contacts(inverse_masses(1.0));
        contacts.add(on_ground(0.5));
        Points v = moving(along, 2.0);
        contacts.solve(10, 0.0, v);
        EXPECT_NEAR(v(0, 0), std::max(0.0, along - 0.5 * 2.0), exact) << along;
    }
}

TEST(CoulombContacts, HeightsAndTargetsSayWhereToStop) {
    CoulombContacts contacts(inverse_masses(1.0));
    Contact contact = on_ground(10.0);
    contact.height = 0.25;
    contact.target = Vec3(-1.0, 7.0, 0.5);  // its part along the normal does not count
    contacts.add(contact);
    Points x = moving(0.3, 2.0);
    contacts.solve(10, 0.0, x);
    EXPECT_LT((x.row(0) - Eigen::RowVector3d(-1.0, 0.25, 0.5)).norm(), exact);
}

TEST(CoulombContacts, WhatWasPushedTooMuchBeforehandIsTakenBack) {
    for (const double given : {0.5, 2.0, 2.5, 9.0}) {
        CoulombContacts contacts(inverse_masses(1.0));
        Contact contact = on_ground(0.5);
        contact.push = given;
        contact.rub = Vec3(-0.25, 0.0, 0.0);
        contacts.add(contact);
        Points v = moving(3.0 - 0.25, 2.0 - given);
        contacts.solve(10, 0.0, v);
        EXPECT_NEAR(contacts.push(0), 2.0, exact) << given;
        EXPECT_NEAR(contacts.rub(0).x(), -1.0, exact) << given;
        EXPECT_NEAR(v(0, 0), 2.0, exact) << given;
        EXPECT_NEAR(v(0, 1), 0.0, exact) << given;
    }
    CoulombContacts contacts(inverse_masses(1.0));
    Contact contact = on_ground(0.5);
    contact.push = 1.0;
    contacts.add(contact);
    Points v = moving(0.0, -3.0);  // it leaves faster than it was pushed
    contacts.solve(10, 0.0, v);
    EXPECT_EQ(contacts.push(0), 0.0);
    EXPECT_NEAR(v(0, 1), 2.0, exact);
}

TEST(CoulombContacts, WhereNothingMovesNothingHappens) {
    CoulombContacts contacts(Eigen::Vector2d::Zero());
    contacts.add(on_ground(0.5));
    Points v = moving(3.0, 2.0);
    const Points before = v;
    contacts.solve(10, 0.0, v);
    EXPECT_EQ(v, before);
}

/// Random contacts of faces and edges among random vertices.
struct RandomScene {
    VectorX mass;
    CoulombContacts contacts{VectorX()};
    std::vector<Contact> added;
    Points v;

    explicit RandomScene(unsigned seed) {
        std::mt19937 random(seed);
        constexpr int vertices = 40, count = 30;
        mass.resize(vertices);
        for (int i = 0; i < vertices; ++i) mass[i] = uniform(random, 1e-3, 1e-2);
        contacts = CoulombContacts(mass.cwiseInverse());
        v = random_points(random, vertices, 1.0);
        for (int k = 0; k < count; ++k) {
            Contact contact;
            for (size_t c = 0; c < 4; ++c)
                contact.vertex[c] = static_cast<int>(10 * c + random() % 10);
            const double a = uniform(random, 0.0, 1.0), b = uniform(random, 0.0, 1.0 - a);
            contact.weight = {1.0, -a, -b, -(1.0 - a - b)};
            contact.normal = random_point(random, 1.0).normalized();
            contact.friction = uniform(random, 0.0, 1.0);
            added.push_back(contact);
            contacts.add(contact);
        }
    }

    double kinetic() const { return 0.5 * v.rowwise().squaredNorm().dot(mass); }
    Vec3 momentum() const { return v.transpose() * mass; }
    double approach(const Contact& contact) const {
        double along = 0.0;
        for (size_t k = 0; k < 4; ++k)
            along += contact.weight[k] * contact.normal.dot(v.row(contact.vertex[k]).transpose());
        return -along;
    }
};

TEST(CoulombContacts, MomentumIsKeptAndKineticEnergyNeverRises) {
    for (unsigned seed = 0; seed < 100; ++seed)
        for (const int sweeps : {1, 2, 5, 100}) {
            RandomScene scene(seed);
            const double kinetic = scene.kinetic();
            const Vec3 momentum = scene.momentum();
            scene.contacts.solve(sweeps, 0.0, scene.v);
            EXPECT_LE(scene.kinetic(), kinetic * (1 + exact)) << seed << ", " << sweeps;
            EXPECT_LT((scene.momentum() - momentum).norm(), exact) << seed << ", " << sweeps;
        }
}

TEST(CoulombContacts, EnoughSweepsEndAllApproach) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        RandomScene scene(seed);
        scene.contacts.solve(3000, 1e-9, scene.v);
        for (size_t k = 0; k < scene.added.size(); ++k) {
            EXPECT_LT(scene.approach(scene.added[k]), 1e-5) << seed;
            if (scene.contacts.push(k) == 0.0) continue;
            EXPECT_NEAR(scene.approach(scene.added[k]), 0.0, 1e-5) << seed;
        }
    }
}

}  // namespace
}  // namespace cloth::coulomb_contacts_test
