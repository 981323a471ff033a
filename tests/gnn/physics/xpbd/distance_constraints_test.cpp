#include "gnn/physics/xpbd/distance_constraints.h"

#include <limits>
#include <set>

#include "data/authoring/sheet.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::distance_constraints_test {

namespace {

const double unlimited = std::numeric_limits<double>::infinity();

/// No two constraints of a colour share a vertex, and every spring is there once.
void expect_valid_colours(const std::vector<Spring>& springs, Eigen::Index vertices) {
    const DistanceConstraints constraints(springs, VectorX::Ones(vertices));
    ASSERT_EQ(constraints.size(), springs.size());
    ASSERT_EQ(constraints.colours().back(), static_cast<int>(springs.size()));
    std::multiset<std::pair<int, int>> expected, coloured;
    for (const Spring& spring : springs) expected.insert({spring.a, spring.b});
    for (size_t c = 0; c + 1 < constraints.colours().size(); ++c) {
        std::set<int> used;
        for (int e = constraints.colours()[c]; e < constraints.colours()[c + 1]; ++e) {
            const int* pair = &constraints.vertices()[static_cast<size_t>(2 * e)];
            EXPECT_TRUE(used.insert(pair[0]).second && used.insert(pair[1]).second)
                << "constraint " << e << " of colour " << c;
            coloured.insert({pair[0], pair[1]});
        }
    }
    EXPECT_EQ(coloured, expected);
}

VectorX inverse_masses(double a, double b) {
    VectorX inverse(2);
    inverse << a, b;
    return inverse;
}

/// Two vertices on the x axis at 0 and `length`.
PaddedPoints pair_at(double length) {
    PaddedPoints x = PaddedPoints::Zero(2, 4);
    x(1, 0) = length;
    return x;
}

}  // namespace

TEST(DistanceConstraints, NoTwoOfAColourShareAVertex) {
    const Garment garment("sheet", make_sheet(1.0, 1.0, 2000), Fabric::soft_cotton());
    expect_valid_colours(stretch_springs(garment), garment.vertex_count());
    expect_valid_colours(bending_springs(garment, 0.5), garment.vertex_count());
    std::vector<Spring> star;
    for (int k = 1; k < 200; ++k) star.push_back({0, k, 1.0, 1.0, unlimited});
    expect_valid_colours(star, 200);
    expect_valid_colours({}, 5);
}

TEST(DistanceConstraints, SpringsWithoutStiffnessAreLeftOut) {
    std::vector<Spring> springs = {{0, 1, 1.0, 0.0, unlimited}};
    DistanceConstraints none(springs, inverse_masses(1.0, 1.0));
    EXPECT_EQ(none.size(), 0u);
    springs.push_back({0, 1, 1.0, 1e-9, unlimited});
    springs.push_back({0, 1, 1.0, std::numeric_limits<double>::denorm_min(), unlimited});
    DistanceConstraints soft(springs, inverse_masses(1.0, 1.0));
    EXPECT_EQ(soft.size(), 1u);
    for (DistanceConstraints* constraints : {&none, &soft}) {
        constraints->set_time_step(1e-6);
        PaddedPoints x = pair_at(1.5);
        constraints->relax(x, true);
        constraints->relax(x, false);
        EXPECT_TRUE(x.isApprox(pair_at(1.5)));
    }
}

TEST(DistanceConstraints, OnePassSolvesOneSpring) {
    // Backward Euler of two masses: the force k C at the end of h moves them by h^2 w k C.
    const double k = 50.0, h = 0.01, wa = 30.0, wb = 70.0;
    DistanceConstraints constraints({{0, 1, 1.0, k, unlimited}}, inverse_masses(wa, wb));
    constraints.set_time_step(h);
    PaddedPoints x = pair_at(1.2);
    constraints.relax(x, true);
    const double left = x(1, 0) - x(0, 0) - 1.0;
    EXPECT_NEAR(x(0, 0), h * h * wa * k * left, 1e-12);
    EXPECT_NEAR(x(1, 0) - 1.2, -h * h * wb * k * left, 1e-12);
    const PaddedPoints solved = x;
    constraints.relax(x, false);
    EXPECT_LE((x - solved).norm(), 1e-12) << "a second pass knows the multiplier";
}

TEST(DistanceConstraints, MorePassesSolveAChain) {
    const int count = 6;
    const double k = 40.0, h = 0.01, w = 100.0;
    std::vector<Spring> springs;
    for (int i = 0; i + 1 < count; ++i) springs.push_back({i, i + 1, 0.1, k, unlimited});
    VectorX inverse = VectorX::Constant(count, w);
    inverse[0] = 0.0;
    DistanceConstraints constraints(springs, inverse);
    constraints.set_time_step(h);
    PaddedPoints x = PaddedPoints::Zero(count, 4);
    for (int i = 0; i < count; ++i) x(i, 0) = 0.1 * i + 0.02 * i * i;
    // Independently: (1/w + h^2 K) x = 1/w x~ + h^2 forces of the rest lengths, a linear system.
    Eigen::MatrixXd a = Eigen::MatrixXd::Identity(count, count);
    VectorX b = x.col(0);
    for (int i = 0; i + 1 < count; ++i)
        for (const auto& [row, sign] : {std::pair(i, 1.0), {i + 1, -1.0}}) {
            if (inverse[row] == 0.0) continue;
            a(row, i) += sign * h * h * k * w, a(row, i + 1) -= sign * h * h * k * w;
            b[row] -= sign * h * h * k * w * 0.1;
        }
    const VectorX expected = a.partialPivLu().solve(b);
    for (int pass = 0; pass < 200; ++pass) constraints.relax(x, pass == 0);
    EXPECT_LE((x.col(0) - expected).norm(), 1e-9);
    EXPECT_EQ(x(0, 0), 0.0) << "held";
}

TEST(DistanceConstraints, BeyondTheLimitTheForceGrowsNoMore) {
    DistanceConstraints constraints({{0, 1, 1.0, 50.0, 0.05}}, inverse_masses(1.0, 1.0));
    constraints.set_time_step(0.01);
    const auto moved = [&](double length) {
        PaddedPoints x = pair_at(length);
        constraints.relax(x, true);
        return x(0, 0);
    };
    EXPECT_LT(moved(1.04), moved(1.05));
    EXPECT_DOUBLE_EQ(moved(1.05), moved(3.0));
    EXPECT_LT(moved(0.5), 0.0) << "pressed together it pushes";
}

TEST(DistanceConstraints, ASpringOfNoLengthOrWithoutAFreeEndStaysFinite) {
    DistanceConstraints constraints({{0, 1, 1.0, 50.0, unlimited}}, inverse_masses(0.0, 0.0));
    constraints.set_time_step(1e-6);
    for (const double length : {0.0, 2.0}) {
        PaddedPoints x = pair_at(length);
        constraints.relax(x, true);
        EXPECT_EQ(x, pair_at(length));
    }
}

}  // namespace cloth::distance_constraints_test
