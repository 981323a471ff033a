#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "collision/proximity/metrics.h"
#include "data/body/garment_skinning.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "gnn/skinning/skinning_stepper.h"
#include "tests/gnn/skinning/random_skinning.h"

namespace cloth::skinning_test {

using namespace cloth::test;

namespace {

constexpr double dt = 1.0 / 30.0;

const Garment& shirt() {
    static const Garment garment = load_garment("tshirt_1000");
    return garment;
}

SkinningStepper stepper_of(double size, bool project = false, const Garment& garment = shirt()) {
    SkinningStepperSettings settings;
    settings.project = project;
    return {garment, std::make_shared<const SkinningWeights>(random_skinning(shirt(), size)),
            std::make_shared<const Body>(walker()->body()), settings};
}

/// The step of the walker from frame to frame + 1, turned and moved.
Boundary step_of(int frame, const Pose& pose = Pose::Identity()) {
    Boundary boundary;
    boundary.obstacles = {walker()->obstacle(frame * dt, (frame + 1) * dt)};
    for (Points* x : {&boundary.obstacles[0].x0, &boundary.obstacles[0].x1})
        *x = ((*x * pose.linear().transpose()).rowwise() + pose.translation().transpose()).eval();
    boundary.pin_targets.resize(0, 3);
    return boundary;
}

ClothState after(SkinningStepper& stepper, int first, int last,
                 const Pose& pose = Pose::Identity()) {
    ClothState state = ClothState::at_rest(shirt());
    for (int frame = first; frame < last; ++frame)
        EXPECT_TRUE(stepper.step(step_of(frame, pose), dt, state).finite) << frame;
    return state;
}

TEST(SkinningPeer, WithoutDisplacementsItIsTheSkinnedGarment) {
    SkinningStepper stepper = stepper_of(0.0);
    const ClothState state = after(stepper, 40, 50);
    const SkinGoals goals = skinned_goals(skin_garment(shirt().rest().vertices, *walker()),
                                          *walker(), 49 * dt, 50 * dt);
    EXPECT_LT((state.x - goals.x1).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_LT((state.v - (goals.x1 - goals.x0) / dt).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_NEAR(state.time, 10 * dt, 1e-12);
}

TEST(SkinningPeer, PlaceAndYawMakeNoDifference) {
    const Pose pose =
        Pose(Eigen::Translation3d(3.0, 0.5, -2.0)) * Pose(Eigen::AngleAxisd(1.2, Vec3::UnitY()));
    SkinningStepper here = stepper_of(1.0), there = stepper_of(1.0);
    const Points x = after(here, 40, 52).x, moved = after(there, 40, 52, pose).x;
    const Points expected =
        ((x * pose.linear().transpose()).rowwise() + pose.translation().transpose());
    EXPECT_LT((moved - expected).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(SkinningPeer, PosesOfBeforeMakeADifference) {
    SkinningStepper long_memory = stepper_of(1.0), short_memory = stepper_of(1.0);
    const Points longer = after(long_memory, 40, 52).x, shorter = after(short_memory, 51, 52).x;
    EXPECT_GT((longer - shorter).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(SkinningPeer, AfterAJumpTheBodyCountsAsHavingStoodStill) {
    SkinningStepper jumped = stepper_of(1.0), fresh = stepper_of(1.0);
    ClothState state = after(jumped, 40, 46), other = ClothState::at_rest(shirt());
    ASSERT_TRUE(jumped.step(step_of(90), dt, state).finite);
    ASSERT_TRUE(fresh.step(step_of(90), dt, other).finite);
    EXPECT_TRUE(same_points(state.x, other.x));
}

TEST(SkinningPeer, TheStateOfTheClothMakesNoDifference) {
    SkinningStepper first = stepper_of(1.0), second = stepper_of(1.0);
    ClothState state = ClothState::at_rest(shirt()), other = state;
    other.x.array() += 0.3;
    other.v.setConstant(2.0);
    ASSERT_TRUE(first.step(step_of(60), dt, state).finite);
    ASSERT_TRUE(second.step(step_of(60), dt, other).finite);
    EXPECT_TRUE(same_points(state.x, other.x));
}

TEST(SkinningPeer, EqualStepsGiveEqualBitsOnAnyNumberOfThreads) {
    std::vector<ClothState> results;
    for (const int threads : {1, 2, 3}) {
        omp_set_num_threads(threads);
        SkinningStepper stepper = stepper_of(1.0, /*project=*/true);
        results.push_back(after(stepper, 60, 66));
    }
    omp_set_num_threads(1);
    EXPECT_TRUE(same_points(results[0].x, results[1].x));
    EXPECT_TRUE(same_points(results[0].x, results[2].x));
}

TEST(SkinningPeer, ProjectionLeavesNothingInsideTheBody) {
    SkinningStepper raw = stepper_of(4.0), projected = stepper_of(4.0, true);
    EXPECT_EQ(raw.name(), "skinning-raw");
    EXPECT_EQ(projected.name(), "skinning");
    Proximity proximity;
    ClothState state = ClothState::at_rest(shirt()), other = state;
    ASSERT_TRUE(raw.step(step_of(60), dt, state).finite);
    const StepReport report = projected.step(step_of(60), dt, other);
    ASSERT_TRUE(report.finite);
    EXPECT_GT(measure_penetration(proximity, step_of(60), shirt(), state.x).vertex_depth, 5e-3);
    EXPECT_LT(measure_penetration(proximity, step_of(60), shirt(), other.x).vertex_depth, 1e-3);
    EXPECT_GT(report.max_entry, 5e-3);
}

TEST(SkinningPeer, StepsThatItCannotMakeFailAndChangeNothing) {
    SkinningStepper stepper = stepper_of(1.0);
    const ClothState before = ClothState::at_rest(shirt());
    const auto expect_failure = [&](const Boundary& boundary, double step, const char* what) {
        ClothState state = before;
        EXPECT_FALSE(stepper.step(boundary, step, state).finite) << what;
        EXPECT_TRUE(same_points(state.x, before.x) && same_points(state.v, before.v) &&
                    state.time == before.time)
            << what;
    };
    Boundary nobody = step_of(60);
    nobody.obstacles.clear();
    expect_failure(nobody, dt, "no body");
    expect_failure(step_of(60), 1.0 / 60.0, "another time step");
    Boundary wider = step_of(60);
    wider.obstacles[0].x1.col(0) *= 1.2;  // an affine map of the skin would be one of all joints
    for (Eigen::Index i = 0; i < wider.obstacles[0].x1.rows(); ++i)
        wider.obstacles[0].x1(i, 1) += 0.01 * std::sin(80.0 * wider.obstacles[0].x1(i, 1));
    expect_failure(wider, dt, "another body");
    Boundary broken = step_of(60);
    broken.obstacles[0].x0(5, 1) = std::numeric_limits<double>::quiet_NaN();
    expect_failure(broken, dt, "not finite");
    ClothState state = before;
    EXPECT_TRUE(stepper.step(step_of(60), dt, state).finite) << "and it goes on";
}

TEST(SkinningPeer, PinsAreOnTheirTargets) {
    const Garment pinned("pinned", shirt().rest(), Fabric::soft_cotton(), {3, 10});
    SkinningStepper stepper = stepper_of(1.0, true, pinned);
    Boundary boundary = step_of(60);
    boundary.pin_targets.resize(2, 3);
    boundary.pin_targets << 0.1, 2.0, 0.3, 0.4, 2.1, 0.6;
    ClothState state = ClothState::at_rest(pinned);
    ASSERT_TRUE(stepper.step(boundary, dt, state).finite);
    EXPECT_LT((state.x.row(3) - boundary.pin_targets.row(0)).norm(), 1e-12);
    EXPECT_LT((state.x.row(10) - boundary.pin_targets.row(1)).norm(), 1e-12);
}

template <class Error, class Action>
std::string message_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(SkinningPeer, OtherGarmentsAreRefused) {
    const Garment pants = load_garment("pants_1000");
    EXPECT_NE(message_of<ArgumentError>([&] { stepper_of(1.0, true, pants); }).find("tshirt_1000"),
              std::string::npos);
    TriMesh longer = shirt().rest();
    longer.vertices.col(1) *= 1.1;
    const Garment stretched("stretched", longer, Fabric::soft_cotton());
    EXPECT_NE(
        message_of<ArgumentError>([&] { stepper_of(1.0, true, stretched); }).find("stretched"),
        std::string::npos);
    EXPECT_THROW(SkinningStepper(shirt(), nullptr, nullptr), ArgumentError);
}

TEST(SkinningWeights, SavedAndLoadedTheyAreTheSame) {
    const std::string file = testing::TempDir() + "skinning.safetensors";
    const SkinningWeights saved = random_skinning(shirt());
    saved.save(file);
    const SkinningWeights loaded = SkinningWeights::load(file);
    EXPECT_EQ(loaded.config.to_json(), saved.config.to_json());
    ASSERT_EQ(loaded.tensors.size(), saved.tensors.size());
    for (const auto& [name, tensor] : saved.tensors)
        EXPECT_EQ(loaded.tensor(name).data, tensor.data) << name;
    std::filesystem::remove(file);
}

TEST(SkinningWeights, BrokenOnesAreRefusedByName) {
    const std::string file = testing::TempDir() + "broken.safetensors";
    const auto refusal = [&](const auto& spoil) {
        SkinningWeights weights = random_skinning(shirt());
        spoil(weights);
        return message_of<ArgumentError>([&] { weights.save(file); });
    };
    const auto names = [](const std::string& text, const char* what) {
        return text.find(what) != std::string::npos;
    };
    EXPECT_TRUE(names(refusal([](auto& w) { w.tensors.erase("rest"); }), "tensor rest"));
    EXPECT_TRUE(names(refusal([](auto& w) { w.tensors["skin"].data[2] += 0.5f; }), "tensor skin"));
    EXPECT_TRUE(names(refusal([](auto& w) { w.tensors["input.deviation"].data[1] = 0.0f; }),
                      "input.deviation"));
    EXPECT_TRUE(names(refusal([](auto& w) { w.config.ages = {0, 4, 2}; }), "ages[2]"));
    EXPECT_TRUE(names(refusal([](auto& w) { w.config.joints.pop_back(); }), "shape"));
    // A network of the other kind.
    EXPECT_TRUE(names(message_of<LoadError>(
                          [] { SkinningWeights::load(asset_path("weights/small.safetensors")); }),
                      "fastcloth-skinning"));
    EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace

}  // namespace cloth::skinning_test
