#include "collision/self/layer_contacts.h"

#include <gtest/gtest.h>

#include "collision/self/self_tangles.h"
#include "tests/collision/self/self_scenes.h"

namespace cloth::layer_contacts_test {
namespace {

using namespace test;

constexpr double thickness = 4e-3, dt = 1.0 / 60;

/// Sheets above each other, each a part, that move as they are told.
struct Layers {
    MergedGarments sheets;
    std::vector<int> part;
    VectorX masses;
    std::vector<double> friction;
    Points x0, x, v;

    explicit Layers(double gap, double friction_of_all = 0.0, std::vector<int> pins = {})
        : sheets(two_sheets(gap, 300)), masses(sheets.garment.masses()) {
        if (!pins.empty()) sheets.garment = sheets.garment.with_pins(pins);
        part.assign(static_cast<size_t>(masses.size()), 0);
        std::fill(part.begin() + above(), part.end(), 1);
        friction.assign(2, friction_of_all);
        x0 = x = sheets.garment.rest().vertices;
        v = Points::Zero(x.rows(), 3);
    }

    int above() const { return sheets.first_vertex[1]; }
    LayerContacts contacts(int threads = 0) const {
        LayerContactSettings settings;
        settings.thickness = thickness;
        settings.threads = threads;
        return LayerContacts(sheets.garment, part, masses, friction, settings);
    }
    void set_velocity(int of, const Vec3& velocity) {
        for (Eigen::Index i = 0; i < x.rows(); ++i)
            if (part[static_cast<size_t>(i)] == of) v.row(i) = velocity;
        x = x0 + dt * v;
    }
    /// Places where a sheet passes through the other one.
    int tangles() const {
        const Garment& garment = sheets.garment;
        SelfTangles all(garment);
        int count = 0;
        for (const Tangle& tangle : all.find(x)) {
            const int vertex = garment.edges()[static_cast<size_t>(tangle.edge)][0];
            const int corner = garment.rest().faces(tangle.face, 0);
            count += part[static_cast<size_t>(vertex)] != part[static_cast<size_t>(corner)];
        }
        return count;
    }
    double kinetic() const { return 0.5 * v.rowwise().squaredNorm().dot(masses); }
    Vec3 momentum() const { return v.transpose() * masses; }
    Vec3 centre_times_mass() const { return x.transpose() * masses; }
};

/// The ground y = 0 as an obstacle.
class Ground : public LayerContacts::Outside {
 public:
    explicit Ground(double distance) : m_distance(distance) {}

    double push_out(const std::vector<int>& rows, Points& x) override {
        double deepest = 0.0;
        for (const int i : rows) {
            deepest = std::max(deepest, -x(i, 1));
            x(i, 1) = std::max(x(i, 1), m_distance);
        }
        m_contacts.obstacle.assign(static_cast<size_t>(x.rows()), 0);
        m_contacts.point1 = x;
        m_contacts.point1.col(1).setZero();
        m_contacts.normal1 = Points::Zero(x.rows(), 3);
        m_contacts.normal1.col(1).setOnes();
        m_contacts.distance = x.col(1);
        return deepest;
    }
    const SurfaceContacts& contacts() const override { return m_contacts; }

 private:
    double m_distance;
    SurfaceContacts m_contacts;
};

TEST(LayerContacts, ClothThatMeetsNothingKeepsItsBits) {
    Layers layers(0.02, 0.5);
    layers.set_velocity(1, Vec3(0.5, -0.8, 0.1));
    const Points x = layers.x, v = layers.v;
    const auto report = layers.contacts().resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
    EXPECT_EQ(report.pairs + report.crossings + report.left, 0);
    EXPECT_TRUE(layers.x == x);
    EXPECT_TRUE(layers.v == v);
}

TEST(LayerContacts, FacesOfOnePieceDoNotMeet) {
    Layers layers(2e-3, 0.5);
    std::fill(layers.part.begin(), layers.part.end(), 0);
    layers.set_velocity(1, Vec3(0.0, -0.5, 0.0));
    const Points x = layers.x;
    layers.contacts().resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
    EXPECT_TRUE(layers.x == x);
}

TEST(LayerContacts, AFallingSheetIsCaughtAndTakesTheOtherAlong) {
    for (const double speed : {0.1, 1.0, 5.0}) {
        Layers layers(5e-3);
        layers.set_velocity(1, Vec3(0.0, -speed, 0.0));
        const double kinetic = layers.kinetic();
        const Vec3 momentum = layers.momentum(), centre = layers.centre_times_mass();
        const auto report = layers.contacts().resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
        EXPECT_EQ(report.left, 0) << speed;
        EXPECT_TRUE(speed * dt < 1e-3 || report.pairs > 100) << speed;
        EXPECT_EQ(layers.tangles(), 0) << speed;
        EXPECT_LT((layers.momentum() - momentum).norm(), 1e-12) << speed;
        EXPECT_LT((layers.centre_times_mass() - centre).norm(), 1e-12) << speed;
        EXPECT_LE(layers.kinetic(), kinetic) << speed;
        // An inelastic collision of equal masses leaves half of the energy, rounding aside.
        if (report.pairs == 0) continue;
        EXPECT_NEAR(layers.kinetic(), 0.5 * kinetic, 0.05 * kinetic) << speed;
    }
}

TEST(LayerContacts, FrictionCarriesAlongWithinItsCone) {
    for (const double friction : {0.0, 0.2, 5.0}) {
        Layers layers(4.1e-3, friction);
        layers.set_velocity(1, Vec3(0.4, -1.0, 0.0));
        layers.contacts().resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
        const int above = layers.above();
        const double mass = layers.masses.tail(layers.x.rows() - above).sum();
        // Of two equal sheets each gives the other at most half of what it has more.
        const double along = layers.v.col(0).head(above).dot(layers.masses.head(above)) / mass;
        const double down = -layers.v.col(1).head(above).dot(layers.masses.head(above)) / mass;
        EXPECT_NEAR(down, 0.5, 0.03) << friction;
        EXPECT_NEAR(along, std::min(0.2, friction * down), 0.02) << friction;
    }
}

TEST(LayerContacts, LayersThatAreTooCloseAreNotThrownApart) {
    Layers layers(1e-3);
    layers.contacts().resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
    const int above = layers.above();
    const double gap =
        layers.x.col(1).tail(layers.x.rows() - above).mean() - layers.x.col(1).head(above).mean();
    EXPECT_NEAR(gap, 1e-3 + 0.1 * (0.5 * thickness - 1e-3), 3e-5) << "a tenth of what is missing";
    EXPECT_EQ(layers.v.norm(), 0.0);
}

TEST(LayerContacts, WhatLastsIsForecastAndTakenBackWhereItIsTooMuch) {
    Layers layers(3e-3);
    LayerContacts contacts = layers.contacts();
    const int above = layers.above();
    const double mass = layers.masses.tail(layers.x.rows() - above).sum();
    const Vec3 pressing(0.0, -0.01, 0.0);
    for (int step = 0; step < 3; ++step) {
        const Points forecast = contacts.forecast();
        EXPECT_LT((forecast.colwise().sum()).norm(), 1e-12);
        const double up = forecast.col(1).tail(layers.x.rows() - above).sum();
        const double pushed = 0.5 * mass * 0.01;  // equal masses share it
        EXPECT_NEAR(up, step < 2 ? 0.0 : pushed, 1e-2 * pushed) << "the first is no more than that";
        layers.v = Points::Zero(layers.x.rows(), 3);
        layers.v.bottomRows(layers.x.rows() - above).rowwise() += pressing.transpose();
        layers.v += layers.masses.cwiseInverse().asDiagonal() * forecast;
        layers.x = layers.x0 + dt * layers.v;
        contacts.resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
        // The same, whether it was told beforehand or found.
        EXPECT_NEAR(layers.v.col(1).tail(layers.x.rows() - above).mean(), -0.005, 1e-3) << step;
    }
    const Points forecast = contacts.forecast();
    layers.v = layers.masses.cwiseInverse().asDiagonal() * forecast;  // nothing presses any more
    layers.x = layers.x0 + dt * layers.v;
    contacts.resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
    EXPECT_LT(layers.v.rowwise().norm().maxCoeff(), 1e-3);
    contacts.forget_forecast();
    EXPECT_EQ(contacts.forecast().norm(), 0.0);
}

TEST(LayerContacts, PinsStayAndHold) {
    std::vector<int> pins(100);
    for (int i = 0; i < 100; ++i) pins[static_cast<size_t>(i)] = i;
    Layers layers(5e-3, 0.3, pins);
    layers.set_velocity(1, Vec3(0.2, -3.0, 0.0));
    const Points x = layers.x;
    const auto report = layers.contacts().resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
    EXPECT_EQ(report.left, 0);
    for (const int pin : pins) {
        EXPECT_EQ(layers.x.row(pin), x.row(pin));
        EXPECT_EQ(layers.v.row(pin).norm(), 0.0);
    }
}

TEST(LayerContacts, BetweenASheetAndTheGroundNothingPasses) {
    constexpr double distance = 5e-4;
    Layers layers(5e-3, 0.3);
    for (Points* points : {&layers.x0, &layers.x}) points->col(1).array() += distance;
    layers.set_velocity(1, Vec3(0.1, -2.0, 0.0));
    Ground ground(distance);
    const auto report = layers.contacts().resolve(layers.x0, distance, &ground, layers.x, layers.v);
    EXPECT_EQ(report.left, 0);
    EXPECT_EQ(layers.tangles(), 0);
    EXPECT_GT(layers.x.col(1).minCoeff(), distance - 1e-4);
    for (Eigen::Index i = layers.above(); i < layers.x.rows(); ++i) {
        if (layers.x0.row(i).cwiseAbs().maxCoeff() > 0.14) continue;  // hangs over the edge
        EXPECT_GT(layers.x(i, 1), distance + 0.4 * thickness) << i;
    }
}

/// A crumpled sheet that is thrown at another, with all the invariants.
TEST(LayerContacts, WhateverMeetsMakesNoEnergyAndPassesThroughNothing) {
    int met = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
        std::mt19937 random(seed);
        Layers layers(uniform(random, 5e-3, 8e-3), uniform(random, 0.0, 1.0));
        const double wave = uniform(random, 0.0, 2e-3), turn = uniform(random, 10.0, 60.0);
        for (Eigen::Index i = 0; i < layers.x.rows(); ++i)
            layers.x0(i, 1) +=
                wave * std::sin(turn * layers.x0(i, 0)) * std::cos(turn * layers.x0(i, 2));
        const Vec3 throwing(uniform(random, -2.0, 2.0), uniform(random, 0.2, 2.0), 0.0);
        for (Eigen::Index i = 0; i < layers.x.rows(); ++i) {
            const double side = layers.part[static_cast<size_t>(i)] == 1 ? 1.0 : -1.0;
            const Vec3 noise = random_point(random, 0.3);
            layers.v.row(i) = side * Vec3(throwing.x(), -throwing.y(), throwing.z()) + noise;
        }
        layers.x = layers.x0 + dt * layers.v;
        const double kinetic = layers.kinetic();
        const Vec3 momentum = layers.momentum(), centre = layers.centre_times_mass();
        Points x = layers.x, v = layers.v;
        const auto report = layers.contacts(1).resolve(layers.x0, 0.0, nullptr, layers.x, layers.v);
        met += report.pairs + report.crossings > 0;
        EXPECT_EQ(report.left, 0) << seed;
        EXPECT_EQ(layers.tangles(), 0) << seed;
        EXPECT_LE(layers.kinetic(), kinetic * (1 + 1e-12)) << seed;
        EXPECT_LT((layers.momentum() - momentum).norm(), 1e-12) << seed;
        EXPECT_LT((layers.centre_times_mass() - centre).norm(), 1e-12) << seed;
        layers.contacts(3).resolve(layers.x0, 0.0, nullptr, x, v);
        EXPECT_TRUE(x == layers.x && v == layers.v) << seed << ": threads change bits";
    }
    EXPECT_GT(met, 8);
}

}  // namespace
}  // namespace cloth::layer_contacts_test
