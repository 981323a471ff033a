#include "collision/proximity/limb_overlap.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/proximity/obstacle_trees.h"
#include "collision/proximity/proximity.h"
#include "data/core/errors.h"
#include "tests/two_limbs.h"

namespace cloth::limb_overlap_test {
namespace {

using namespace test;

constexpr double dt = 1.0 / 30.0;
constexpr LimbSet trunk = 1, arm = 2;

/// Cloth that hugs the trunk, 2 mm off.
ClothState shell() {
    const Points x = 0.152 * icosphere(2).vertices;
    return {x, Points::Zero(x.rows(), 3)};
}

int ignoring(const Boundary& boundary, LimbSet limb) {
    return static_cast<int>(std::count_if(boundary.ignored_limbs.begin(),
                                          boundary.ignored_limbs.end(),
                                          [&](LimbSet limbs) { return (limbs & limb) != 0; }));
}

int pinched(const Boundary& boundary) {
    EXPECT_EQ(boundary.pinched.size(), boundary.ignored_limbs.size());
    return static_cast<int>(
        std::count_if(boundary.pinched.begin(), boundary.pinched.end(), [](char p) { return p; }));
}

TEST(LimbOverlap, LeavesABodyWithoutOverlapAlone) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    const ClothState state = shell();
    for (int frame = 0; frame < 3; ++frame) {
        const Boundary boundary = body.boundary(0.25, 0.22);  // touches the cloth: it is 1.8 cm off
        EXPECT_EQ(&limbs.filter(boundary, dt, state), &boundary);
    }
    const Boundary empty;
    EXPECT_EQ(&limbs.filter(empty, dt, state), &empty);
    EXPECT_TRUE(limbs.ignored().empty());
}

TEST(LimbOverlap, AllClothIgnoresACoveredLimbUntilItIsClear) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    const ClothState state = shell();
    limbs.filter(body.boundary(0.3, 0.3), dt, state);
    const Boundary& covered = limbs.filter(body.boundary(0.24, 0.17), dt, state);
    EXPECT_EQ(ignoring(covered, arm), state.x.rows());
    EXPECT_EQ(pinched(covered), 0) << "by limbs that are not joined";
    EXPECT_EQ(ignoring(limbs.filter(body.boundary(0.17, 0.17), dt, state), trunk), 0);
    // out of the trunk, but not of the cloth
    EXPECT_EQ(ignoring(limbs.filter(body.boundary(0.17, 0.205), dt, state), arm), state.x.rows());
    EXPECT_EQ(ignoring(limbs.filter(body.boundary(0.205, 0.205), dt, state), arm), state.x.rows());
    // clear by more than a centimetre
    limbs.filter(body.boundary(0.205, 0.24), dt, state);
    EXPECT_EQ(ignoring(limbs.filter(body.boundary(0.24, 0.24), dt, state), arm), 0);
    EXPECT_EQ(limbs.ignored(), std::vector<LimbSet>(size_t(state.x.rows()), 0));
}

TEST(LimbOverlap, TwoGarmentsShareOneFitOfEachPose) {
    const TwoLimbs body(false);
    const auto trees = std::make_shared<ObstacleTrees>();
    LimbOverlap shirt, skirt, alone;
    const ClothState state = shell();
    const std::vector<double> way = {0.3, 0.24, 0.17, 0.16, 0.205, 0.25, 0.26};
    int ignored = 0;
    for (size_t step = 0; step + 1 < way.size(); ++step) {
        Boundary boundary = body.boundary(way[step], way[step + 1]);
        ignored += ignoring(alone.filter(boundary, dt, state), arm) > 0;
        boundary.trees = trees;
        trees->begin_step();
        EXPECT_EQ(shirt.filter(boundary, dt, state).trees, trees);
        EXPECT_EQ(skirt.filter(boundary, dt, state).trees, trees);
        EXPECT_EQ(shirt.ignored(), alone.ignored());
        EXPECT_EQ(skirt.ignored(), alone.ignored());
        EXPECT_EQ(trees->counts().surface_fits, static_cast<long>(step) + 2);
    }
    EXPECT_GT(ignored, 2);
}

TEST(LimbOverlap, AJoinedLimbIsIgnoredOnlyWhereItFoldsIn) {
    const TwoLimbs body(true);
    LimbOverlap limbs;
    const ClothState state = shell();
    limbs.filter(body.boundary(0.3, 0.3), dt, state);
    const Boundary& outside = limbs.filter(body.boundary(0.17, 0.17), dt, state);
    const int count = ignoring(outside, arm);
    EXPECT_GT(count, 0);
    EXPECT_LT(count, state.x.rows() / 2);
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        if (ignored_limbs(outside, static_cast<int>(i)) == 0) continue;
        EXPECT_LT((state.x.row(i) - Eigen::RowVector3d(0.17, 0, 0)).norm(), 0.05)
            << "outside the arm";
    }
}

/// Cloth that hugs the arm, 2 mm off.
ClothState sleeve(double x) {
    const Points points = (0.052 * icosphere(2).vertices).rowwise() + Eigen::RowVector3d(x, 0, 0);
    return {points, Points::Zero(points.rows(), 3)};
}

/// The part of a sleeve that its arm takes into the trunk stays on the arm.
TEST(LimbOverlap, ASleeveFollowsItsArmIntoTheTrunk) {
    const TwoLimbs body(true);
    LimbOverlapSettings settings;
    settings.pinch_cover = 0.0;
    LimbOverlap limbs(settings);
    limbs.filter(body.boundary(0.3, 0.3), dt, sleeve(0.3));
    const ClothState folded = sleeve(0.14);
    const Boundary& outside = limbs.filter(body.boundary(0.14, 0.14), dt, folded);
    for (Eigen::Index i = 0; i < folded.x.rows(); ++i) {
        const double depth = 0.15 - folded.x.row(i).norm();
        if (std::abs(depth) < 0.005) continue;
        EXPECT_EQ((ignored_limbs(outside, static_cast<int>(i)) & trunk) != 0, depth > 0.0) << i;
        EXPECT_EQ(is_pinched(outside, i), depth > 0.0) << i;
    }
}

TEST(LimbOverlap, SaysWhereSkinsOverlapUnderLayers) {
    constexpr double margin = 0.01, little = 0.003;  // what balls of triangles leave open
    LimbOverlapSettings settings;
    settings.layer_room = 1e-4;
    for (const bool joined : {false, true})
        for (const bool is_sleeve : {false, true}) {
            const TwoLimbs body(joined);
            LimbOverlap limbs(settings), silent;
            const ClothState before = is_sleeve ? sleeve(0.3) : shell();
            const Boundary apart = body.boundary(0.3, 0.3), in = body.boundary(0.14, 0.14);
            EXPECT_TRUE(limbs.filter(apart, dt, before).overlapped.empty());
            silent.filter(apart, dt, before);
            const ClothState folded = is_sleeve ? sleeve(0.14) : shell();
            const Boundary& outside = limbs.filter(in, dt, folded);
            EXPECT_TRUE(silent.filter(in, dt, folded).overlapped.empty());
            ASSERT_EQ(outside.overlapped.size(), size_t(folded.x.rows()));
            int marked = 0, clear = 0;
            for (Eigen::Index i = 0; i < folded.x.rows(); ++i) {
                const Eigen::RowVector3d other(is_sleeve ? 0.0 : 0.14, 0, 0);
                const double distance =
                    (folded.x.row(i) - other).norm() - (is_sleeve ? 0.15 : 0.05);
                const bool ignored = ignored_limbs(outside, static_cast<int>(i)) != 0;
                const double reach = ignored ? margin : 0.0;
                if (distance < reach - little && ignored) {
                    EXPECT_NE(outside.overlapped[size_t(i)], 0) << i;
                    ++marked;
                }
                if (distance > reach + little) {
                    EXPECT_EQ(outside.overlapped[size_t(i)], 0) << i;
                    ++clear;
                }
            }
            EXPECT_GT(marked, 2);
            EXPECT_GT(clear, 5);
        }
}

TEST(LimbOverlap, SaysWhereSkinsLeaveNoRoomForLayers) {
    const TwoLimbs body(false);
    const Boundary near = body.boundary(0.205, 0.205);  // 5 mm between the skins
    const ClothState state = shell();
    const auto marked = [&](double room) {
        LimbOverlapSettings settings;
        settings.layer_room = room;
        LimbOverlap limbs(settings);
        const std::vector<char> overlapped = limbs.filter(near, dt, state).overlapped;
        for (Eigen::Index i = 0; i < state.x.rows() && !overlapped.empty(); ++i) {
            const Eigen::RowVector3d x = state.x.row(i), centre(0.205, 0, 0);
            const double between = x.norm() - 0.15 + (x - centre).norm() - 0.05;
            const bool facing = x.normalized().dot((x - centre).normalized()) < -0.5;
            if (std::abs(between - room) < 0.002) continue;
            EXPECT_EQ(overlapped[size_t(i)] != 0, between < room && facing) << i;
        }
        return std::count(overlapped.begin(), overlapped.end(), 1);
    };
    EXPECT_EQ(marked(0.004), 0);
    EXPECT_GT(marked(0.012), 0);
    EXPECT_GT(marked(0.03), marked(0.012));
    EXPECT_EQ(marked(0.0), 0);
}

/// How much of the trunk (m) lies over the skin of an arm at `arm_x` below a point near it; below
/// zero: none.
double cover_of_trunk(const Eigen::RowVector3d& point, double arm_x) {
    const Eigen::RowVector3d centre(arm_x, 0, 0);
    const Eigen::RowVector3d up = (point - centre).normalized(), skin = centre + 0.05 * up;
    const double along = skin.dot(up), inside = 0.15 * 0.15 - skin.squaredNorm();
    return inside < 0.0 ? -1.0 : std::sqrt(along * along + inside) - along;
}

TEST(LimbOverlap, OnlyWhatIsDeepInAFoldIsPinched) {
    const TwoLimbs body(true);
    const ClothState folded = sleeve(0.14);
    for (const double least : {0.01, 0.04, 0.08}) {
        LimbOverlapSettings settings;
        settings.pinch_cover = least;
        LimbOverlap limbs(settings);
        limbs.filter(body.boundary(0.3, 0.3), dt, sleeve(0.3));
        const Boundary& outside = limbs.filter(body.boundary(0.14, 0.14), dt, folded);
        int deep = 0, shallow = 0;
        for (Eigen::Index i = 0; i < folded.x.rows(); ++i) {
            const double cover = cover_of_trunk(folded.x.row(i), 0.14);
            if (std::abs(cover - least) < 0.0125) continue;  // a face's normal is not the ball's
            EXPECT_EQ(is_pinched(outside, i), cover > least) << i << ", " << cover;
            (cover > least ? deep : shallow) += 1;
        }
        EXPECT_GT(deep, 0) << least;
        EXPECT_GT(shallow, 0) << least;
    }
}

/// It still ignores the trunk until there is room for it.
TEST(LimbOverlap, ASleeveIsPinchedOnlyWhileItsArmIsInTheTrunk) {
    const TwoLimbs body(true);
    LimbOverlap limbs;
    limbs.filter(body.boundary(0.3, 0.3), dt, sleeve(0.3));
    EXPECT_GT(pinched(limbs.filter(body.boundary(0.14, 0.14), dt, sleeve(0.14))), 0);
    limbs.filter(body.boundary(0.14, 0.208), dt, sleeve(0.14));
    const Boundary& outside = limbs.filter(body.boundary(0.208, 0.208), dt, sleeve(0.208));
    EXPECT_GT(ignoring(outside, trunk), 0);
    EXPECT_EQ(pinched(outside), 0);
}

TEST(LimbOverlap, AThinCoverIsContact) {
    const TwoLimbs body(true);
    const auto ignoring_arm = [&](double least_cover) {
        LimbOverlapSettings settings;
        settings.least_cover = least_cover;
        LimbOverlap limbs(settings);
        limbs.filter(body.boundary(0.3, 0.3), dt, shell());
        return ignoring(limbs.filter(body.boundary(0.17, 0.17), dt, shell()), arm);
    };
    EXPECT_GT(ignoring_arm(0.01), 0);
    EXPECT_EQ(ignoring_arm(0.1), 0);  // the arm lies 7 cm thick over the trunk's skin
}

/// Of 5 cm.
Obstacle ball_of_limb_2(const Vec3& at) {
    const TriMesh ball = icosphere(2);
    Obstacle obstacle;
    obstacle.faces = std::make_shared<const Faces>(ball.faces);
    obstacle.limbs = std::make_shared<const std::vector<std::uint8_t>>(ball.faces.rows(), 2);
    obstacle.x0 = obstacle.x1 = (0.05 * ball.vertices).rowwise() + at.transpose();
    return obstacle;
}

/// A limb that folds into the one that it is joined to stays solid for other cloth.
TEST(LimbOverlap, AFoldBuriesNoLimb) {
    const auto with_sleeve_on_another_limb = [](bool joined) {
        const TwoLimbs body(joined);
        ClothState cloth = sleeve(0.17);
        cloth.x.col(1).array() += 0.135;
        LimbOverlap limbs;
        Boundary boundary = body.boundary(0.3, 0.12);
        boundary.obstacles.push_back(ball_of_limb_2({0.17, 0.135, 0}));
        return ignoring(limbs.filter(boundary, dt, cloth), arm);
    };
    EXPECT_GT(with_sleeve_on_another_limb(false), 0);
    EXPECT_EQ(with_sleeve_on_another_limb(true), 0);
}

TEST(LimbOverlap, ClothAtHomeOnTheLimbKeepsToIt) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    limbs.filter(body.boundary(0.3, 0.3), dt, sleeve(0.3));
    const ClothState moved = sleeve(0.17);
    const Boundary& outside = limbs.filter(body.boundary(0.17, 0.17), dt, moved);
    EXPECT_EQ(ignoring(outside, arm), 0);
    EXPECT_EQ(ignoring(outside, trunk), moved.x.rows());
}

TEST(LimbOverlap, FarClothHasNoHomeAndIgnoresNothing) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    ClothState state = shell();
    state.x.array() += 1.0;
    const Boundary boundary = body.boundary(0.17, 0.17);
    EXPECT_EQ(&limbs.filter(boundary, dt, state), &boundary);
}

TEST(LimbOverlap, AnotherBodyIsLearntAnew) {
    const TwoLimbs body(false), other(false);
    LimbOverlap limbs;
    const ClothState state = shell();
    limbs.filter(body.boundary(0.17, 0.17), dt, state);
    EXPECT_EQ(ignoring(limbs.filter(other.boundary(0.3, 0.3), dt, state), arm), 0);
    const Points x = 0.152 * icosphere(1).vertices;
    const ClothState coarse{x, Points::Zero(x.rows(), 3)};
    EXPECT_EQ(ignoring(limbs.filter(other.boundary(0.17, 0.17), dt, coarse), arm), x.rows());
}

TEST(LimbOverlap, UnusableLimbsAreNone) {
    const TwoLimbs body(false);
    const ClothState state = shell();
    Boundary boundary = body.boundary(0.17, 0.17);
    auto wrong = std::make_shared<std::vector<std::uint8_t>>(*boundary.obstacles[0].limbs);
    wrong->back() = 32;
    boundary.obstacles[0].limbs = wrong;
    EXPECT_EQ(&LimbOverlap().filter(boundary, dt, state), &boundary);
    wrong->resize(3);
    EXPECT_EQ(&LimbOverlap().filter(boundary, dt, state), &boundary);
}

TEST(LimbOverlap, OtherObstaclesMayComeAndGo) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    const ClothState state = shell();
    limbs.filter(body.boundary(0.3, 0.3), dt, state);
    limbs.filter(body.boundary(0.17, 0.17), dt, state);
    // still inside the cloth: only who remembers goes on to ignore it
    Boundary more = body.boundary(0.205, 0.205);
    more.obstacles.insert(more.obstacles.begin(),
                          primitive(ObstacleShape::sphere, Vec3::Zero(), 0.01));
    EXPECT_EQ(ignoring(limbs.filter(more, dt, state), arm), state.x.rows());
    EXPECT_EQ(ignoring(LimbOverlap().filter(more, dt, state), arm), 0);
}

Obstacle shifted(Obstacle body, const Vec3& by, int id) {
    for (Points* x : {&body.x0, &body.x1}) x->rowwise() += by.transpose();
    body.id = id;
    return body;
}

TEST(LimbOverlap, ACharacterThatPassesByChangesNothing) {
    const TwoLimbs body(false), another(false);
    const ClothState state = shell();
    const std::vector<double> way = {0.3, 0.24, 0.17, 0.17, 0.205, 0.205, 0.205, 0.205, 0.24, 0.24};
    for (const TwoLimbs* mesh : {&body, &another}) {
        LimbOverlap alone, passed;
        int ignored = 0;
        for (size_t step = 0; step + 1 < way.size(); ++step) {
            Boundary boundary = body.boundary(way[step], way[step + 1]);
            ignored += ignoring(alone.filter(boundary, dt, state), arm) > 0;
            boundary.obstacles[0].id = 1;
            if (step % 3 != 0) {  // its arm is covered; it is 3 cm off the cloth
                const Obstacle other =
                    shifted(mesh->boundary(0.17, 0.16).obstacles[0], {0, 0.335, 0}, 2);
                const auto front = boundary.obstacles.begin();
                boundary.obstacles.insert(step % 2 ? front : front + 1, other);
            }
            passed.filter(boundary, dt, state);
            EXPECT_EQ(passed.ignored(), alone.ignored()) << step;
        }
        EXPECT_GT(ignored, 5);
    }
}

TEST(LimbOverlap, AnotherCharacterIsTouchedWhateverTheClothIgnores) {
    const TwoLimbs body(false);
    const ClothState state = shell();
    LimbOverlap alone, limbs;
    Boundary before = body.boundary(0.3, 0.3), boundary = body.boundary(0.17, 0.16);
    before.obstacles[0].id = boundary.obstacles[0].id = 1;
    alone.filter(before, dt, state);
    limbs.filter(before, dt, state);
    alone.filter(boundary, dt, state);
    // its arm is over the cloth
    boundary.obstacles.push_back(shifted(body.boundary(0.3, 0.3).obstacles[0], {-0.3, 0.21, 0}, 2));
    const Boundary& outside = limbs.filter(boundary, dt, state);
    ASSERT_EQ(ignoring(outside, arm), state.x.rows());
    EXPECT_FALSE(outside.obstacles[0].is_whole);
    EXPECT_TRUE(outside.obstacles[1].is_whole);
    Eigen::Index top = 0;
    state.x.col(1).maxCoeff(&top);
    Points x = state.x;
    x.row(top) << 0, 0.17, 0;
    SurfaceContacts contacts;
    Proximity().query(x, outside, contacts);
    EXPECT_EQ(contacts.obstacle[size_t(top)], 1);
    EXPECT_NEAR(contacts.distance[top], -0.01, 5e-4);
    EXPECT_EQ(limbs.measure_ignored(x).depth, alone.measure_ignored(x).depth);
}

TEST(LimbOverlap, AThingWithoutLimbsIsTouchedWhateverTheClothIgnores) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    limbs.filter(body.boundary(0.3, 0.3), dt, sleeve(0.3));
    Boundary boundary = body.boundary(0.17, 0.17);
    TriMesh ball = icosphere(3);
    ball.vertices *= 0.05;
    boundary.obstacles.push_back(shifted(mesh_obstacle(ball), {0.17, 0.11, 0}, 0));
    ClothState state = sleeve(0.17);
    const Boundary& outside = limbs.filter(boundary, dt, state);
    ASSERT_EQ(ignoring(outside, trunk), state.x.rows());
    state.x.row(0) << 0.17, 0.07, 0;
    SurfaceContacts contacts;
    Proximity().query(state.x, outside, contacts);
    EXPECT_EQ(contacts.obstacle[0], 1);
    EXPECT_NEAR(contacts.distance[0], -0.01, 5e-4);
}

TEST(LimbOverlap, OfEqualCharactersClothKeepsToTheOneThatItIsOn) {
    const TwoLimbs body(false);
    const ClothState state = shell();
    LimbOverlap limbs;
    for (const int step : {0, 1, 2}) {
        Boundary boundary = step == 0 ? body.boundary(0.3, 0.3) : body.boundary(0.17, 0.17);
        boundary.obstacles[0].id = 1;
        const Obstacle other = shifted(boundary.obstacles[0], {0, 0.335, 0}, 2);
        boundary.obstacles.insert(boundary.obstacles.begin() + step % 2, other);
        const Boundary& outside = limbs.filter(boundary, dt, state);
        EXPECT_EQ(ignoring(outside, arm), step > 0 ? state.x.rows() : 0);
        if (step == 0) continue;
        for (const Obstacle& obstacle : outside.obstacles)
            EXPECT_EQ(obstacle.is_whole, obstacle.id == 2);
    }
    // it is gone: the other one is the cloth's now
    const Boundary boundary =
        boundary_of({shifted(body.boundary(0.4, 0.4).obstacles[0], {0, 0.335, 0}, 2)});
    EXPECT_EQ(ignoring(limbs.filter(boundary, dt, state), arm), 0);
    limbs.filter(body.boundary(0.3, 0.3), dt, state);
    EXPECT_EQ(ignoring(limbs.filter(body.boundary(0.17, 0.17), dt, state), arm), state.x.rows());
}

TEST(LimbOverlap, LimbsOfOtherNumbersMayComeAndGo) {
    const TwoLimbs body(false);
    const Obstacle hat = ball_of_limb_2({0, 0.21, 0});
    const ClothState state = shell();
    LimbOverlap limbs;
    limbs.filter(body.boundary(0.3, 0.3), dt, state);
    limbs.filter(body.boundary(0.17, 0.17), dt, state);
    for (const bool there : {true, true, false, true}) {
        Boundary boundary = body.boundary(0.205, 0.205);
        if (there) boundary.obstacles.insert(boundary.obstacles.begin(), hat);
        EXPECT_EQ(ignoring(limbs.filter(boundary, dt, state), arm), state.x.rows());
    }
}

int deeper_than(const Points& x, const Vec3& centre, double radius, double depth) {
    return static_cast<int>(
        ((x.rowwise() - centre.transpose()).rowwise().norm().array() < radius - depth).count());
}

/// The arm's skin, a polyhedron, is up to half a millimetre below its sphere. Cloth that still
/// touches a joined arm does not count.
void expect_depth_in_arm(const IgnoredDepth& ignored, const Points& x, double arm_x,
                         bool joined = false) {
    const Vec3 centre(arm_x, 0, 0);
    const double nearest = (x.rowwise() - centre.transpose()).rowwise().norm().minCoeff();
    EXPECT_NEAR(ignored.depth, 0.05 - nearest, 5e-4);
    EXPECT_LE(ignored.vertices, deeper_than(x, centre, 0.05, 0.0));
    EXPECT_GE(ignored.vertices, joined ? 1 : deeper_than(x, centre, 0.05, 5e-4));
}

TEST(LimbOverlap, TellsHowDeepClothIsInALimbThatItIgnores) {
    for (const bool joined : {false, true}) {
        const TwoLimbs body(joined);
        LimbOverlap limbs;
        const ClothState state = shell();
        limbs.filter(body.boundary(0.3, 0.3), dt, state);
        EXPECT_EQ(limbs.measure_ignored(state.x).vertices, 0);
        EXPECT_EQ(limbs.measure_ignored(state.x).depth, 0.0);
        limbs.filter(body.boundary(0.17, 0.16), dt, state);
        ASSERT_GT(deeper_than(state.x, Vec3(0.16, 0, 0), 0.05, 0.0), 5);
        for (int twice = 0; twice < 2; ++twice)
            expect_depth_in_arm(limbs.measure_ignored(state.x), state.x, 0.16, joined);
    }
}

TEST(LimbOverlap, NoOtherObstacleHidesTheIgnoredLimb) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    const ClothState state = shell();
    Boundary boundary = body.boundary(0.17, 0.17);
    limbs.filter(boundary, dt, state);
    boundary.obstacles.insert(boundary.obstacles.begin(),
                              primitive(ObstacleShape::sphere, Vec3::Zero(), 1.0));
    limbs.filter(boundary, dt, state);
    expect_depth_in_arm(limbs.measure_ignored(state.x), state.x, 0.17);
}

TEST(LimbOverlap, VerticesThatAreLeftOutAreNotDeep) {
    const TwoLimbs body(false);
    LimbOverlap limbs;
    const ClothState state = shell();
    limbs.filter(body.boundary(0.17, 0.17), dt, state);
    std::vector<char> left_out(size_t(state.x.rows()), 1);
    EXPECT_EQ(limbs.measure_ignored(state.x, left_out).depth, 0.0);
    Eigen::Index deepest = 0;
    state.x.col(0).maxCoeff(&deepest);
    left_out[size_t(deepest)] = 0;
    EXPECT_EQ(limbs.measure_ignored(state.x, left_out).vertices, 1);
}

TEST(LimbOverlap, SettingsOutOfRangeAreNamed) {
    for (const LimbOverlapSettings wrong :
         {LimbOverlapSettings{0.5, 0.01, 0.04}, LimbOverlapSettings{0.05, 0.0, 0.04},
          LimbOverlapSettings{std::nan(""), 0.01, 0.04}, LimbOverlapSettings{0.05, 0.01, -1.0}})
        EXPECT_THROW(LimbOverlap{wrong}, ArgumentError);
}

}  // namespace
}  // namespace cloth::limb_overlap_test
