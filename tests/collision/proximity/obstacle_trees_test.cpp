// Hierarchies that several queriers share must never show in what they answer, only in what it
// costs.

#include "collision/proximity/obstacle_trees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <thread>

#include "collision/ccd/tunnelling.h"
#include "collision/geometry/motion_tree.h"
#include "collision/proximity/mesh_surface.h"
#include "collision/proximity/tree_fits.h"
#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "tests/collision/proximity/same_bits.h"
#include "tests/test_meshes.h"

namespace cloth::obstacle_trees_test {
namespace {

using namespace test;
using test::expect_same_bits;  // beside that of Answers

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A rough body of two limbs that turns and swells: each step starts as the last one ended.
class RoughBody {
 public:
    RoughBody() : m_rest(mesh_obstacle(roughened(icosphere(3), 0.1, 1))) {
        auto limbs = std::make_shared<std::vector<std::uint8_t>>();
        for (Eigen::Index f = 0; f < m_rest.faces->rows(); ++f)
            limbs->push_back(m_rest.x0((*m_rest.faces)(f, 0), 0) > 0.0 ? 1 : 0);
        m_rest.limbs = limbs;
    }
    Obstacle between(double from, double to) const {
        Obstacle obstacle = m_rest;
        obstacle.x0 = at(from);
        obstacle.x1 = at(to);
        return obstacle;
    }
    Boundary step(int index, std::shared_ptr<ObstacleTrees> trees = nullptr) const {
        Boundary boundary = boundary_of({between(index, index + 1)});
        boundary.trees = std::move(trees);
        return boundary;
    }

 private:
    Points at(double t) const {
        const double swell = 1 + 0.2 * std::sin(0.3 * t);
        return transformed(m_rest.x0, pose_of({0.05 * t, 0, 0}, 0.1 * t)) * swell;
    }
    Obstacle m_rest;
};

/// All that a querier answers in one step.
struct Answers {
    SurfaceContacts start, end, some;
    VectorX distance;
    std::vector<std::optional<Cover>> covers;

    Answers(Proximity& proximity, const Boundary& boundary, const Points& x) {
        proximity.query(x, boundary, start);
        for (Eigen::Index i = 0; i < x.rows(); i += 7)
            covers.push_back(proximity.cover(start, i, StepEnd::start));
        proximity.query(x, boundary, end, StepEnd::end);
        for (Eigen::Index i = 0; i < x.rows(); i += 7)
            covers.push_back(proximity.cover(end, i, StepEnd::end, 1));
        some = start;
        std::vector<int> rows;
        for (int i = 0; i < x.rows(); i += 3) rows.push_back(i);
        const std::vector<LimbSet> ignored(size_t(x.rows()), 2);
        proximity.query_rows(x, rows, boundary, some, StepEnd::end, {&ignored, 0.2});
        proximity.signed_distance(x, boundary, StepEnd::start, distance);
    }
};

void expect_same_bits(const Answers& a, const Answers& b) {
    expect_same_bits(a.start, b.start);
    expect_same_bits(a.end, b.end);
    expect_same_bits(a.some, b.some);
    EXPECT_EQ(a.distance, b.distance);
    ASSERT_EQ(a.covers.size(), b.covers.size());
    for (size_t k = 0; k < a.covers.size(); ++k) {
        ASSERT_EQ(a.covers[k].has_value(), b.covers[k].has_value());
        if (!a.covers[k]) continue;
        EXPECT_EQ(a.covers[k]->depth, b.covers[k]->depth);
        EXPECT_EQ(a.covers[k]->face, b.covers[k]->face);
    }
}

Answers fresh_answers(const Boundary& boundary, const Points& x) {
    Boundary alone = boundary;
    alone.trees = nullptr;
    Proximity fresh({0.4, 1});
    return Answers(fresh, alone, x);
}

TEST(ObstacleTrees, TwoQueriersShareOneFitOfEachPose) {
    std::mt19937 random(1);
    const RoughBody body;
    const Points x = random_points(random, 300, 1.4), y = random_points(random, 200, 1.4);
    const auto trees = std::make_shared<ObstacleTrees>();
    Proximity shirt({0.4, 0}), skirt({0.4, 0});
    for (int step = 0; step < 5; ++step) {
        trees->begin_step();
        const Boundary boundary = body.step(step, trees);
        expect_same_bits(Answers(shirt, boundary, x), fresh_answers(boundary, x));
        expect_same_bits(Answers(skirt, boundary, y), fresh_answers(boundary, y));
        EXPECT_EQ(trees->counts().builds, 1);
        EXPECT_EQ(trees->counts().surface_fits, 2 + step);  // both ends of the first step, then
                                                            // the end of each
    }
    EXPECT_EQ(trees->meshes(), 1);
    EXPECT_EQ(trees->counts().motion_fits, 0);
}

TEST(ObstacleTrees, StepsThatDoNotJoinCostAFitOfEachEnd) {
    const RoughBody body;
    const Points x = Points::Constant(1, 3, 0.8);
    const auto trees = std::make_shared<ObstacleTrees>();
    Proximity shirt, skirt;
    for (int step = 0; step < 4; ++step) {
        trees->begin_step();
        const Boundary boundary = body.step(10 * step, trees);
        Answers(shirt, boundary, x), Answers(skirt, boundary, x);
        EXPECT_EQ(trees->counts().surface_fits, 2 * (step + 1));
    }
}

TEST(ObstacleTrees, HistoryAndSubStepsDoNotShow) {
    std::mt19937 random(2);
    const RoughBody body;
    const Points x = random_points(random, 150, 1.4);
    const auto trees = std::make_shared<ObstacleTrees>();
    Proximity proximity({0.4, 0});
    for (const bool crowded : {false, true})  // sub-steps that pass through the world's trees, too
        for (const int step : {0, 1, 2, 9, 8, 8, 3}) {
            trees->begin_step();
            for (int part = 0; part < 24; ++part) {
                const double from = step + part / 24.0, to = step + (part + 1) / 24.0;
                Boundary boundary = boundary_of({body.between(from, to)});
                if (crowded) boundary.trees = trees;
                const Points some = x.topRows(20);
                expect_same_bits(Answers(proximity, boundary, some), fresh_answers(boundary, some));
            }
            const Boundary boundary = body.step(step, trees);
            expect_same_bits(Answers(proximity, boundary, x), fresh_answers(boundary, x));
        }
}

TEST(ObstacleTrees, SubStepsWithoutThemLeaveTheWorldsFitsAlone) {
    const RoughBody body;
    const Points x = Points::Constant(1, 3, 0.8);
    const auto trees = std::make_shared<ObstacleTrees>();
    trees->begin_step();
    Proximity shirt, skirt;
    Answers(shirt, body.step(0, trees), x);
    for (int part = 0; part < 64; ++part)
        Answers(shirt, boundary_of({body.between(part / 64.0, (part + 1) / 64.0)}), x);
    Answers(skirt, body.step(0, trees), x);
    EXPECT_EQ(trees->counts().surface_fits, 2);
}

TEST(ObstacleTrees, AdoptedHierarchiesAreNotBuiltAgainAndAnswerAlike) {
    std::mt19937 random(5);
    const RoughBody body;
    const Points x = random_points(random, 200, 1.4);
    const auto world = std::make_shared<ObstacleTrees>(), own = std::make_shared<ObstacleTrees>();
    Proximity shirt({0.4, 0});
    const Boundary whole = body.step(0, world);
    own->adopt(*world, whole.obstacles[0]);
    EXPECT_EQ(own->counts().builds, 0) << "there is nothing to adopt yet";
    Answers(shirt, whole, x);
    world->prepare_motion(whole.obstacles[0]);
    ASSERT_EQ(world->counts().builds, 2);
    own->adopt(*world, whole.obstacles[0]);
    Boundary part = boundary_of({body.between(0.25, 0.5)});
    const Answers expected = fresh_answers(part, x);
    part.trees = own;
    expect_same_bits(Answers(shirt, part, x), expected);
    EXPECT_TRUE(own->motion(part.obstacles[0]));
    EXPECT_EQ(own->counts().builds, 0);
    EXPECT_EQ(world->counts().builds, 2);

    const auto narrow = std::make_shared<ObstacleTrees>(ObstacleTreesSettings{0.2, 10});
    narrow->adopt(*world, whole.obstacles[0]);
    narrow->surface(whole.obstacles[0], StepEnd::start);
    EXPECT_EQ(narrow->counts().builds, 1) << "made for another radius";
}

TEST(ObstacleTrees, ThreadsOfAQueryDoNotShow) {
    std::mt19937 random(3);
    const RoughBody body;
    const Points x = random_points(random, 1500, 1.4);
    const auto trees = std::make_shared<ObstacleTrees>();
    for (int step = 0; step < 3; ++step) {
        trees->begin_step();
        const Boundary boundary = body.step(step, trees);
        const Answers expected = fresh_answers(boundary, x);
        for (const int threads : {1, 2, 4, 7}) {
            Proximity proximity({0.4, threads});
            expect_same_bits(Answers(proximity, boundary, x), expected);
        }
    }
}

TEST(ObstacleTrees, GarmentsMayBeSteppedFromSeveralThreads) {
    std::mt19937 random(4);
    const RoughBody body;
    constexpr int garments = 4, steps = 6;
    const auto trees = std::make_shared<ObstacleTrees>();
    std::vector<Points> x;
    std::vector<Proximity> queriers;
    for (int k = 0; k < garments; ++k) {
        x.push_back(random_points(random, 60 + 10 * k, 1.4));
        queriers.emplace_back(ProximitySettings{0.4, 1});
    }
    for (int step = 0; step < steps; ++step) {
        trees->begin_step();
        const Boundary boundary = body.step(step, trees);
        std::vector<std::unique_ptr<Answers>> found(garments);
        std::vector<std::thread> threads;
        for (size_t k = 0; k < garments; ++k)
            threads.emplace_back([&, k] {
                found[k] = std::make_unique<Answers>(queriers[k], boundary, x[k]);
                trees->motion(boundary.obstacles[0]);
            });
        for (std::thread& thread : threads) thread.join();
        for (size_t k = 0; k < garments; ++k)
            expect_same_bits(*found[k], fresh_answers(boundary, x[k]));
    }
    EXPECT_EQ(trees->counts().builds, 2);  // surface and motion
    EXPECT_EQ(trees->counts().surface_fits, steps + 1);
    EXPECT_EQ(trees->counts().motion_fits, steps);
}

/// Threads that are not in step overwrite poses that others have just let go of.
TEST(ObstacleTrees, ThreadsMayBeAtDifferentPoses) {
    std::mt19937 random(5);
    const RoughBody body;
    const auto trees = std::make_shared<ObstacleTrees>();
    const Points x = random_points(random, 20, 1.4);
    constexpr int count = 30;
    std::vector<std::vector<std::unique_ptr<Answers>>> found(3);
    std::vector<std::thread> threads;
    for (auto& mine : found)
        threads.emplace_back([&] {
            Proximity proximity({0.4, 1});
            for (int step = 0; step < count; ++step) {
                trees->begin_step();
                mine.push_back(
                    std::make_unique<Answers>(proximity, body.step(step % 11, trees), x));
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (int step = 0; step < count; ++step) {
        const Answers expected = fresh_answers(body.step(step % 11), x);
        for (const auto& mine : found) expect_same_bits(*mine[size_t(step)], expected);
    }
}

TEST(ObstacleTrees, WhatMotionNeedsIsBuiltAheadAndOnce) {
    const RoughBody body;
    const auto trees = std::make_shared<ObstacleTrees>();
    for (int step = 0; step < 3; ++step) {
        trees->begin_step();
        trees->prepare_motion(body.step(step, trees).obstacles[0]);
        EXPECT_EQ(trees->counts().builds, 1);
        EXPECT_EQ(trees->counts().motion_fits, 0);
    }
    const Boundary boundary = body.step(3, trees);
    const std::shared_ptr<const MotionTree> prepared = trees->motion(boundary.obstacles[0]);
    ASSERT_TRUE(prepared);
    EXPECT_EQ(trees->counts().builds, 1);
    ObstacleTrees fresh;
    const std::shared_ptr<const MotionTree> built = fresh.motion(boundary.obstacles[0]);
    const auto faces_met = [&](const MotionTree& tree) {
        std::vector<int> stack, faces;
        tree.for_each_met(tree.box_of(Vec3(-0.9, 0.1, 0.0), Vec3(1.8, 0.0, 0.0)), 0.0f, stack,
                          [&](int face) { faces.push_back(face); });
        std::sort(faces.begin(), faces.end());
        return faces;
    };
    EXPECT_FALSE(faces_met(*built).empty());
    EXPECT_EQ(faces_met(*prepared), faces_met(*built));
    Obstacle sphere;
    sphere.shape = ObstacleShape::sphere;
    trees->prepare_motion(sphere);
    EXPECT_EQ(trees->counts().builds, 1);
}

TEST(ObstacleTrees, AMeshThatChangesInPlaceIsNoticed) {
    const RoughBody body;
    const Points x = Points::Constant(1, 3, 0.8);
    const auto trees = std::make_shared<ObstacleTrees>();
    Proximity proximity({0.4, 0});
    Boundary boundary = body.step(0, trees);
    expect_same_bits(Answers(proximity, boundary, x), fresh_answers(boundary, x));
    trees->motion(boundary.obstacles[0]);
    const ObstacleTrees::Counts before = trees->counts();
    Points& x1 = boundary.obstacles[0].x1;
    x1(x1.rows() - 1, 2) += 1e-15;  // the last vertex, by a few units in the last place
    expect_same_bits(Answers(proximity, boundary, x), fresh_answers(boundary, x));
    trees->motion(boundary.obstacles[0]);
    EXPECT_EQ(trees->counts().surface_fits, before.surface_fits + 1);
    EXPECT_EQ(trees->counts().motion_fits, before.motion_fits + 1);
    EXPECT_EQ(trees->counts().builds, before.builds);
}

TEST(ObstacleTrees, WhatIsHeldStaysAsItIs) {
    const RoughBody body;
    ObstacleTrees trees;
    const Obstacle first = body.between(0, 1);
    const std::shared_ptr<const MeshSurface> held = trees.surface(first, StepEnd::start);
    for (int step = 0; step < 40; ++step) {
        trees.begin_step();
        trees.surface(body.between(step + 1, step + 2), StepEnd::end);
        EXPECT_EQ(held->vertices(), first.x0);
    }
    EXPECT_EQ(trees.counts().builds, 1);
}

TEST(ObstacleTrees, UnusableMeshesArePassedOver) {
    const Obstacle cube_mesh = mesh_obstacle(cube());
    ObstacleTrees trees;
    const auto is_passed_over = [&](const Obstacle& obstacle) {
        return !trees.surface(obstacle, StepEnd::start) && !trees.surface(obstacle, StepEnd::end) &&
               !trees.motion(obstacle);
    };
    EXPECT_FALSE(is_passed_over(cube_mesh));
    EXPECT_TRUE(is_passed_over(Obstacle()));
    EXPECT_TRUE(is_passed_over(primitive(ObstacleShape::sphere, Vec3::Zero(), 1.0)));
    EXPECT_TRUE(is_passed_over(mesh_obstacle({Points(0, 3), Faces(0, 3)})));
    Obstacle broken = cube_mesh;
    broken.x1 = Points::Zero(7, 3);
    EXPECT_TRUE(is_passed_over(broken));
    broken.x0 = broken.x1;  // a corner is missing
    EXPECT_TRUE(is_passed_over(broken));
    EXPECT_FALSE(is_passed_over(cube_mesh));  // the same faces
    broken.x0 = broken.x1 = Points::Zero(9, 3);
    EXPECT_FALSE(is_passed_over(broken));

    Obstacle not_finite = cube_mesh;
    not_finite.x1(3, 1) = nan;
    EXPECT_TRUE(trees.surface(not_finite, StepEnd::end));  // without the faces of that vertex
    EXPECT_FALSE(trees.motion(not_finite));
    EXPECT_TRUE(trees.motion(cube_mesh));
}

TEST(ObstacleTrees, UnusableMeshesAreAnsweredAsByOwnTrees) {
    std::mt19937 random(6);
    const Points x = random_points(random, 100, 1.4);
    const RoughBody body;
    const auto trees = std::make_shared<ObstacleTrees>();
    Proximity proximity({0.4, 0});
    Obstacle hole = body.between(0, 1), short_end = hole, wrong_limbs = hole;
    hole.x0(5, 0) = hole.x1(9, 1) = nan;
    short_end.x1.conservativeResize(10, 3);
    wrong_limbs.limbs = std::make_shared<std::vector<std::uint8_t>>(3, 0);
    for (const Obstacle& obstacle : {hole, short_end, wrong_limbs, Obstacle(), hole}) {
        Boundary boundary = boundary_of({obstacle, body.between(3, 4)});
        boundary.trees = trees;
        expect_same_bits(Answers(proximity, boundary, x), fresh_answers(boundary, x));
    }
}

TEST(ObstacleTrees, OneMeshMayStandInAWorldTwice) {
    const auto trees = std::make_shared<ObstacleTrees>();
    Obstacle first = mesh_obstacle(cube()), second = first;
    second.x0 = second.x1 = transformed(first.x0, pose_of({5, 0, 0}));
    Boundary boundary = boundary_of({first, second});
    boundary.trees = trees;
    Points x(2, 3);
    x << 1.1, 0, 0, 6.1, 0, 0;
    Proximity proximity({0.5, 0});
    for (int step = 0; step < 3; ++step) {
        trees->begin_step();
        expect_same_bits(Answers(proximity, boundary, x), fresh_answers(boundary, x));
        EXPECT_EQ(trees->counts().builds, 1);
        EXPECT_EQ(trees->counts().surface_fits, 2);
    }
}

TEST(ObstacleTrees, BodiesOfOneMeshCostOneFitEachHoweverManyTheyAre) {
    const RoughBody body;
    const Points x = Points::Constant(1, 3, 0.8);
    for (const int count : {8, 9, 20}) {
        const auto trees = std::make_shared<ObstacleTrees>();
        Proximity shirt({0.4, 0}), skirt({0.4, 0});
        long before = 0;
        for (int step = 0; step < 6; ++step) {
            trees->begin_step();
            Boundary boundary;
            for (int k = 0; k < count; ++k)
                boundary.obstacles.push_back(body.between(100 * k + step, 100 * k + step + 1));
            boundary.trees = trees;
            Answers(shirt, boundary, x), Answers(skirt, boundary, x);
            if (step > 2) {
                EXPECT_EQ(trees->counts().surface_fits - before, count) << step;
            }
            before = trees->counts().surface_fits;
        }
    }
}

/// Trees that exist at present.
struct Counted {
    explicit Counted(int pose_of) : pose(pose_of) { ++alive; }
    Counted(const Counted& other) : pose(other.pose) { ++alive; }
    Counted& operator=(const Counted&) = default;
    ~Counted() { --alive; }
    int pose;
    inline static int alive = 0;
};

TEST(TreeFits, AreNoMoreThanTheLastStepUsed) {
    TreeFits<Counted> fits;
    const auto use = [&](long step, int poses) {
        for (int k = 0; k < poses; ++k) {
            const int pose = static_cast<int>(1000 * step) + k;
            auto tree = fits.take(step);
            if (!tree) tree = std::make_unique<Counted>(pose);
            tree->pose = pose;
            fits.add(step, std::move(tree));
        }
    };
    constexpr int spares = 2;
    use(1, 40);
    EXPECT_LE(Counted::alive, 16 + spares);
    for (const long step : {2L, 3L}) use(step, 40);
    EXPECT_GE(Counted::alive, 40);
    EXPECT_LE(Counted::alive, 40 + spares);
    use(4, 2000);
    use(5, 2000);
    EXPECT_LE(Counted::alive, 256 + spares);
    for (const long step : {6L, 7L, 8L}) use(step, 3);
    EXPECT_LE(Counted::alive, 6 + spares);
}

TEST(ObstacleTrees, MeshesAreForgottenWhenNotShown) {
    ObstacleTrees trees({0.5, 10});
    std::weak_ptr<const Faces> faces;
    {
        const Obstacle obstacle = mesh_obstacle(cube());
        faces = obstacle.faces;
        trees.surface(obstacle, StepEnd::start);
    }
    EXPECT_EQ(trees.meshes(), 1);
    for (int step = 0; step < 10; ++step) trees.begin_step();
    EXPECT_FALSE(faces.expired());  // the key cannot be recycled while it is in use
    trees.begin_step();
    EXPECT_EQ(trees.meshes(), 0);
    EXPECT_TRUE(faces.expired());
}

TEST(ObstacleTrees, QueriesThatLookFartherHaveTheirOwn) {
    std::mt19937 random(7);
    const Points x = random_points(random, 100, 1.4);
    const auto trees = std::make_shared<ObstacleTrees>(ObstacleTreesSettings{0.3});
    Proximity proximity({0.4, 0});
    const Boundary boundary = RoughBody().step(0, trees);
    expect_same_bits(Answers(proximity, boundary, x), fresh_answers(boundary, x));
    EXPECT_EQ(trees->counts().builds, 0);
}

TEST(ObstacleTrees, SettingsOutOfRangeAreRefused) {
    EXPECT_THROW(ObstacleTrees({0.0}), ArgumentError);
    EXPECT_THROW(ObstacleTrees({nan}), ArgumentError);
    EXPECT_THROW(ObstacleTrees({0.5, 0}), ArgumentError);
}

/// The parts of one garment, outside of any world.
TEST(ObstacleTrees, QueriersMayBeGivenThem) {
    const RoughBody body;
    const Points x = Points::Constant(1, 3, 0.8);
    const auto trees = std::make_shared<ObstacleTrees>(),
               worlds = std::make_shared<ObstacleTrees>();
    Proximity one({0.4, 0}, trees), two({0.4, 0}, trees);
    Answers(one, body.step(0), x), Answers(two, body.step(0), x);
    EXPECT_EQ(trees->counts().surface_fits, 2);
    Answers(one, body.step(0, worlds), x);  // the world's go first
    EXPECT_EQ(worlds->counts().surface_fits, 2);
    EXPECT_EQ(trees->counts().surface_fits, 2);
}

TEST(ObstacleTrees, TunnellingIsFoundWithOneFitOfTheMotion) {
    const Garment garment("sheet", make_sheet(1.0, 1.0, 400), Fabric::soft_cotton(), {});
    const Points& x = garment.rest().vertices;
    Obstacle ball = mesh_obstacle(icosphere(2));
    const Points rest = 0.1 * ball.x0;
    const auto trees = std::make_shared<ObstacleTrees>();
    TunnellingDetector shirt(garment), skirt(garment);
    for (int step = 0; step < 4; ++step) {
        ball.x0 = transformed(rest, pose_of({0.1 * step, -0.2, 0}));
        ball.x1 = transformed(rest, pose_of({0.1 * step, 0.2, 0}));
        Boundary boundary = boundary_of({ball});
        TunnellingDetector fresh(garment);
        const std::vector<Tunnelling> expected = fresh.find(boundary, x, x, 1);
        EXPECT_FALSE(expected.empty());
        boundary.trees = trees;
        trees->begin_step();
        for (TunnellingDetector* detector : {&shirt, &skirt}) {
            const std::vector<Tunnelling>& found = detector->find(boundary, x, x, 0);
            ASSERT_EQ(found.size(), expected.size());
            for (size_t k = 0; k < found.size(); ++k) {
                EXPECT_EQ(found[k].point, expected[k].point);
                EXPECT_EQ(found[k].thickness, expected[k].thickness);
            }
        }
        EXPECT_EQ(trees->counts().motion_fits, step + 1);
    }
}

}  // namespace
}  // namespace cloth::obstacle_trees_test
