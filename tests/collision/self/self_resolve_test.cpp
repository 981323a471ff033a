#include "collision/self/self_resolve.h"

#include <gtest/gtest.h>

#include <set>

#include "collision/self/self_crossings.h"
#include "collision/self/self_tangles.h"
#include "tests/collision/self/self_scenes.h"

namespace cloth::self_resolve_test {
namespace {

using namespace test;

/// Six times the volume of the tetrahedron of the four corners, moved on by s motion.
double volume(const std::array<Vec3, 4>& x, const std::array<Vec3, 4>& motion, double s) {
    std::array<Vec3, 4> at;
    for (size_t k = 0; k < 4; ++k) at[k] = x[k] + s * motion[k];
    return (at[1] - at[0]).dot((at[2] - at[0]).cross(at[3] - at[0]));
}

/// Whether elements pass through each other: they do where their corners are in one plane (a root
/// of a cubic, found by bisection between samples) and their closest points are one.
bool pass(bool edges, const std::array<Vec3, 4>& x, const std::array<Vec3, 4>& motion) {
    constexpr int samples = 400;
    for (int k = 0; k < samples; ++k) {
        double low = double(k) / samples, high = double(k + 1) / samples;
        const double first = volume(x, motion, low);
        if (first * volume(x, motion, high) > 0.0) continue;
        for (int halving = 0; halving < 60; ++halving) {
            const double middle = 0.5 * (low + high);
            (first * volume(x, motion, middle) > 0.0 ? low : high) = middle;
        }
        std::array<Vec3, 4> at;
        for (size_t i = 0; i < 4; ++i) at[i] = x[i] + low * motion[i];
        if (closest_points(edges, at).squared < 1e-20) return true;
    }
    return false;
}

double least_distance(bool edges, const std::array<Vec3, 4>& x, const std::array<Vec3, 4>& motion) {
    double least = 1e9;
    for (int k = 0; k <= 2000; ++k) {
        std::array<Vec3, 4> at;
        for (size_t i = 0; i < 4; ++i) at[i] = x[i] + k / 2000.0 * motion[i];
        least = std::min(least, closest_points(edges, at).squared);
    }
    return std::sqrt(least);
}

SelfContactSettings settings(int rounds = 8, int threads = 0) {
    SelfContactSettings contact;
    contact.thickness = 4e-3;
    contact.rounds = rounds;
    contact.threads = threads;
    return contact;
}

Points crumpling(const Points& x, double size) {
    Points motion(x.rows(), 3);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        motion.row(i) << size * std::sin(200 * x(i, 1)), size * std::cos(170 * x(i, 0)),
            size * std::sin(150 * x(i, 0) + 100 * x(i, 1));
    return motion;
}

Vec3 momentum(const Garment& garment, const Points& motion) {
    return motion.transpose() * garment.masses();
}

}  // namespace

TEST(Crosses, AgreesWithTheRootsOfTheVolume) {
    std::mt19937 random(8);
    int crossings = 0, misses = 0;
    for (int repeat = 0; repeat < 3000; ++repeat) {
        const bool edges = repeat % 2 == 0;
        const Points x = random_points(random, 4, 1.0), motion = random_points(random, 4, 1.0);
        const ElementPair pair{{0, 1, 2, 3}, {0, 1}, edges};
        const std::array<Vec3, 4> corners = corners_of(pair, x), moves = corners_of(pair, motion);
        SelfPair found;
        const bool crossing = crosses(pair, x, motion, found);
        if (pass(edges, corners, moves)) {
            ++crossings;
            ASSERT_TRUE(crossing);
            EXPECT_GT(found.distance_at(x), 0.0) << "the side is that of the start";
        } else if (least_distance(edges, corners, moves) > 2e-3) {
            ++misses;
            EXPECT_FALSE(crossing);
        }
    }
    EXPECT_GT(crossings, 200);
    EXPECT_GT(misses, 1000);
}

TEST(SelfCrossings, FindsWhatBruteForceFinds) {
    const Garment garment = strip();
    SelfCrossings crossings(garment);
    const Points x = wound(garment.rest().vertices, 8e-3);
    size_t all = 0;
    for (const double size : {1e-4, 3e-3, 2e-2}) {
        // what all have in common changes nothing
        const Points end = (x + crumpling(x, size)).rowwise() + Eigen::RowVector3d(0.3, -2.0, 0.1);
        const Points motion = end - x;
        std::set<Key> expected, found;
        visit_all(garment, [&](const ElementPair& elements) {
            SelfPair pair;
            if (crosses(elements, x, motion, pair)) expected.insert(key_of(elements));
        });
        for (const SelfPair& pair : crossings.find(x, end, 2)) found.insert(key_of(pair.elements));
        EXPECT_EQ(found, expected) << size;
        EXPECT_EQ(found.size(), crossings.found().size()) << "a pair comes twice";
        EXPECT_TRUE(crossings.passed_over_none());
        all += found.size();
    }
    EXPECT_GT(all, 100u);
}

TEST(SelfCrossings, SayWhetherElementsThatTouchWerePassedOver) {
    const MergedGarments sheets = two_sheets(0.0);
    SelfCrossings crossings(sheets.garment);
    Points x = sheets.garment.rest().vertices;
    const Points end = x + crumpling(x, 1e-3);
    crossings.find(x, end, 1);
    EXPECT_FALSE(crossings.passed_over_none()) << "two sheets at one place";
}

bool are_same(const std::vector<SelfPair>& some, const std::vector<SelfPair>& others) {
    return std::equal(some.begin(), some.end(), others.begin(), others.end(),
                      [](const SelfPair& a, const SelfPair& b) {
                          return key_of(a.elements) == key_of(b.elements) && a.weight == b.weight &&
                                 a.normal == b.normal && a.distance == b.distance;
                      });
}

TEST(SelfCrossings, WhatWasFoundBeforeChangesNothing) {
    const Garment garment = strip();
    SelfCrossings goes_on(garment);
    std::mt19937 random(5);
    Points x = wound(garment.rest().vertices, 8e-3), end = x + crumpling(x, 1e-2);
    std::vector<char> overlapped;
    size_t most = 0, least = 1000000;
    for (int search = 0; search < 60; ++search) {
        if (search % 20 == 19) x += crumpling(x, 1e-3);
        if (search % 30 == 25) overlapped.assign(size_t(x.rows()), 0), overlapped[7] = 1;
        const double share = std::pow(uniform(random, 0.0, 1.0), 4.0);  // mostly few
        for (Eigen::Index i = 0; i < x.rows(); ++i)
            if (uniform(random, 0.0, 1.0) < share) end.row(i) += random_point(random, 5e-3);
        SelfCrossings afresh(garment);
        const auto& found = goes_on.find(x, end, 1 + search % 3, overlapped);
        ASSERT_TRUE(are_same(found, afresh.find(x, end, 1, overlapped))) << search;
        EXPECT_EQ(goes_on.passed_over_none(), afresh.passed_over_none());
        most = std::max(most, found.size());
        least = std::min(least, found.size());
    }
    EXPECT_GT(least, 50u);
    EXPECT_GT(most, 2 * least);
}

TEST(SelfCrossings, PassOverOverlappedVertices) {
    const Garment garment = strip();
    const Points x = wound(garment.rest().vertices, 8e-3), end = x + crumpling(x, 1e-2);
    std::vector<char> overlapped(size_t(x.rows()), 0);
    for (size_t i = 0; i < overlapped.size(); i += 9) overlapped[i] = 1;
    std::vector<SelfPair> expected = SelfCrossings(garment).find(x, end, 1);
    const size_t all = expected.size();
    expected.erase(
        std::remove_if(expected.begin(), expected.end(),
                       [&](const SelfPair& pair) { return has_any(pair.elements, overlapped); }),
        expected.end());
    ASSERT_LT(expected.size(), all);
    ASSERT_GT(expected.size(), 20u);
    SelfCrossings crossings(garment);
    EXPECT_TRUE(are_same(crossings.find(x, end, 1, overlapped), expected));
    EXPECT_FALSE(crossings.passed_over_none());
}

TEST(Crosses, FlatClothThatSlidesInItsPlaneDoesNot) {
    const Garment garment = strip();
    SelfCrossings crossings(garment);
    const Points& x = garment.rest().vertices;
    Points to = 1.02 * x;
    to.rowwise() += Eigen::RowVector3d(0.3, 0.1, 0.2);
    EXPECT_TRUE(crossings.find(x, to, 1).empty());
}

TEST(SelfResolver, KeepsASheetAboveAnother) {
    const MergedGarments sheets = two_sheets(5e-3, 300);
    const Garment& garment = sheets.garment;
    SelfResolver resolver(garment, settings());
    const Points x0 = garment.rest().vertices;
    Points x = x0;
    for (Eigen::Index i = sheets.first_vertex[1]; i < x.rows(); ++i)
        x.row(i) += Eigen::RowVector3d(0.01, -0.02 - 0.02 * x0(i, 0), 0.0);
    const Points before = x;
    const SelfResolveReport report = resolver.resolve(x0, {}, 0.0, x);
    EXPECT_GT(report.crossings, 100);
    EXPECT_EQ(report.left, 0);
    EXPECT_TRUE(SelfTangles(garment).find(x).empty());
    for (Eigen::Index i = sheets.first_vertex[1]; i < x.rows(); ++i)
        EXPECT_GT(x(i, 1), x.topRows(sheets.first_vertex[1]).col(1).minCoeff());
    EXPECT_LT((momentum(garment, x - x0) - momentum(garment, before - x0)).norm(), 1e-12);
    EXPECT_FALSE(resolver.moved().empty());
}

TEST(SelfResolver, HoldsWhatItPushesWithinTheLimitsOfGoals) {
    const MergedGarments sheets = two_sheets(5e-3, 300);
    const Points x0 = sheets.garment.rest().vertices;
    const Eigen::Index upper = sheets.first_vertex[1];
    Points before = x0;  // the upper sheet goes down through the lower one
    before.bottomRows(x0.rows() - upper).rowwise() -= Eigen::RowVector3d(0.0, 0.02, 0.0);
    std::vector<VertexGoal> by_distance, by_backstop;
    for (int i = 0; i < upper; ++i) {
        const Vec3 place = x0.row(i);
        by_distance.push_back({i, place, Vec3::Zero(), 2e-3, 0.0});
        by_backstop.push_back({i, place, Vec3::UnitY(), 1.0, 2e-3});
    }
    const auto resolved = [&](const Garment& garment, const std::vector<VertexGoal>& goals) {
        Points x = before;
        EXPECT_EQ(SelfResolver(garment, settings()).resolve(x0, {}, 0.0, x, false, goals).left, 0);
        EXPECT_TRUE(SelfTangles(garment).find(x).empty());
        return x;
    };
    const auto excess = [](const std::vector<VertexGoal>& goals, const Points& x) {
        double most = 0.0;
        for (const VertexGoal& goal : goals) most = std::max(most, goal.excess(x.row(goal.vertex)));
        return most;
    };
    const Points free = resolved(sheets.garment, {});
    for (const auto& goals : {by_distance, by_backstop}) {
        EXPECT_GT(excess(goals, free), 5e-3) << "the scene asks for nothing";
        EXPECT_LT(excess(goals, resolved(sheets.garment, goals)), 1e-4);
    }
    GoalLimits limits;
    limits.max_distance.setConstant(x0.rows(), 1.0);
    limits.max_distance.head(upper).setZero();
    const Points held = resolved(sheets.garment.with_goals(limits), {});
    EXPECT_EQ(held.topRows(upper), x0.topRows(upper)) << "what never leaves its goal is not pushed";
}

TEST(SelfResolver, ARollThatIsShakenHardDoesNotTangle) {
    const Garment garment = strip(600);
    const Points x0 = wound(garment.rest().vertices, 6e-3);
    ASSERT_TRUE(SelfTangles(garment).find(x0).empty());
    for (const int rounds : {1, 8}) {  // one round leaves work for the rigid zones
        SelfResolver resolver(garment, settings(rounds));
        Points x = x0 + crumpling(x0, 0.01);
        const Points before = x;
        ASSERT_GT(SelfTangles(garment).find(x).size(), 20u);
        const SelfResolveReport report = resolver.resolve(x0, {}, 0.0, x);
        EXPECT_EQ(report.left, 0);
        EXPECT_TRUE(rounds > 1 || report.rigid > 0);
        EXPECT_TRUE(SelfTangles(garment).find(x).empty());
        EXPECT_LT((momentum(garment, x - x0) - momentum(garment, before - x0)).norm(), 1e-12);
        EXPECT_LT((x - before).rowwise().norm().maxCoeff(), 0.05);
    }
}

TEST(SelfResolver, TearsNoClothThatMayPass) {
    const Garment garment = strip(600);
    const auto longest_of = [&](const Points& x, const Points& before) {
        double longest = 0.0;  // of those that the resolver has drawn out
        for (const auto& [a, b] : garment.edges()) {
            const auto length = [&, p = a, q = b](const Points& at) {
                return (at.row(p) - at.row(q)).norm();
            };
            if (length(x) > 1.2000001 * length(before))
                longest = std::max(longest, length(x) / length(garment.rest().vertices));
        }
        return longest;
    };
    int torn = 0, tangled = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::mt19937 random(seed);
        const Points x0 = wound(garment.rest().vertices, uniform(random, 5e-3, 8e-3));
        const Points before =
            x0 + crumpling(x0.rowwise() + Eigen::RowVector3d(random_point(random, 0.1)),
                           uniform(random, 4e-3, 1.2e-2));
        Points held = before, let_go = before;
        SelfResolver resolver(garment, settings(1));
        EXPECT_EQ(resolver.resolve(x0, {}, 0.0, held).left, 0) << seed;
        const SelfResolveReport report = resolver.resolve(x0, {}, 0.0, let_go, true);
        torn += longest_of(held, before) > 1.5;
        tangled += report.left > 0;
        EXPECT_LE(longest_of(let_go, before), 1.5000001) << seed;
        EXPECT_LT(momentum(garment, let_go - before).norm(), 1e-12) << seed;
        if (longest_of(held, before) <= 1.5) {
            EXPECT_EQ(held, let_go) << seed;
        }
    }
    EXPECT_GE(torn, 5);
    EXPECT_GE(tangled, 3);
}

TEST(SelfResolver, WhatDoesNotCrossKeepsItsBits) {
    const Garment garment = strip();
    SelfResolver resolver(garment, settings());
    const Points x0 = wound(garment.rest().vertices, 8e-3);
    Points x = x0.rowwise() + Eigen::RowVector3d(0.2, -0.3, 0.1);
    const Points before = x;
    const SelfResolveReport report = resolver.resolve(x0, {}, 0.0, x);
    EXPECT_EQ(report.crossings, 0);
    EXPECT_TRUE(x == before);
    EXPECT_TRUE(resolver.moved().empty());
}

TEST(SelfResolver, SameBitsForAnyNumberOfThreadsAndPinsStay) {
    const Garment garment = strip(600).with_pins({10, 200});
    const Points x0 = wound(garment.rest().vertices, 6e-3);
    SelfResolver one(garment, settings(4, 1)), three(garment, settings(4, 3));
    Points x = x0 + crumpling(x0, 0.01);
    const Points before = x;
    Points other = x;
    one.resolve(x0, {}, 0.0, x);
    three.resolve(x0, {}, 0.0, other);
    EXPECT_TRUE(x != before);
    EXPECT_TRUE(x == other);
    for (const int pin : garment.pins()) EXPECT_EQ(x.row(pin), before.row(pin));
}

TEST(SelfResolver, ATangledStartIsLeftNoWorse) {
    const MergedGarments sheets = two_sheets(0.0, 300);
    const Garment& garment = sheets.garment;
    Points x0 = garment.rest().vertices;
    // aside, for edges that touch exactly have no side to be kept on
    for (Eigen::Index i = sheets.first_vertex[1]; i < x0.rows(); ++i)
        x0.row(i) += Eigen::RowVector3d(0.0037, 0.2 * x0(i, 0) + 1e-3, 0.0023);
    SelfTangles tangles(garment);
    const size_t tangled = tangles.find(x0).size();
    ASSERT_GT(tangled, 10u);
    SelfResolver resolver(garment, settings());
    Points x = x0;
    for (Eigen::Index i = sheets.first_vertex[1]; i < x0.rows(); ++i) x(i, 1) -= 0.01;
    EXPECT_EQ(resolver.resolve(x0, {}, 0.0, x).left, 0);
    EXPECT_TRUE(x.allFinite());
    EXPECT_LE(tangles.find(x).size(), tangled);
}

TEST(SelfResolver, LetsOverlappedClothPass) {
    const MergedGarments sheets = two_sheets(5e-3);
    SelfResolver resolver(sheets.garment, settings());
    const Points x0 = sheets.garment.rest().vertices;
    Points through = x0;
    for (Eigen::Index i = sheets.first_vertex[1]; i < x0.rows(); ++i) through(i, 1) -= 0.02;
    Points x = through;
    const std::vector<char> all(size_t(x0.rows()), 1);
    EXPECT_EQ(resolver.resolve(x0, {}, 0.0, x, false, {}, all).crossings, 0);
    EXPECT_EQ(x, through);
    EXPECT_GT(resolver.resolve(x0, {}, 0.0, x).crossings, 0);
}

TEST(SelfResolver, RefusesSettingsOutOfRange) {
    SelfContactSettings bad = settings();
    bad.thickness = 0.5;
    EXPECT_THROW(SelfResolver(strip(), bad), std::invalid_argument);
    bad = settings();
    bad.rounds = -1;
    EXPECT_THROW(SelfResolver(strip(), bad), std::invalid_argument);
}

}  // namespace cloth::self_resolve_test
