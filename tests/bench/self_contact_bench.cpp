// What self-contact costs per frame: steps of ten quasi-Newton iterations without and with it, and
// its parts alone.
//
//     build/release/tests/bench/self_contact_bench
//
// `meets`: a sheet folded in half that has come to lie on the floor, each vertex near another
// layer. `apart`: a sheet that hangs over a ball and meets itself nowhere.

#include <benchmark/benchmark.h>

#include <array>
#include <map>

#include "collision/self/self_crossings.h"
#include "collision/self/self_tangles.h"
#include "demos/provenance/provenance.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "tests/gnn/physics/stepper/self_contact_scenes.h"

namespace cloth {
namespace {

using test::LayerScene;

constexpr double dt = 1.0 / 30.0, thickness = 4e-3;
constexpr int frames_before = 12, frames_in_a_row = 4;

LayerScene draped_sheet(int vertices) {
    Garment garment("sheet", make_sheet(0.5, 0.5, vertices), Fabric::soft_cotton());
    ClothState start = ClothState::at_rest(garment);
    start.x.col(1).array() += 0.16;
    return {std::move(garment), std::move(start), test::outside({test::ball(0.15)})};
}

ClothStepperSettings solver(double layer_thickness) {
    ClothStepperSettings settings = ClothStepperSettings::plain();
    settings.step.potential.self_contact.thickness = layer_thickness;
    settings.step.potential.self_contact.threads = 1;
    settings.step.proximity.threads = 1;
    return settings;
}

/// A scene after some frames, with the state that benchmarks start from again and again.
struct Moment {
    LayerScene scene;
    ClothState state;

    explicit Moment(LayerScene made) : scene(std::move(made)), state(scene.start) {
        ClothStepper stepper(scene.garment, solver(thickness));
        for (int frame = 0; frame < frames_before; ++frame) stepper.step(scene.boundary, dt, state);
    }
};

const Moment& moment(bool meets, int vertices) {
    static std::map<std::pair<bool, int>, std::unique_ptr<Moment>> made;
    std::unique_ptr<Moment>& it = made[{meets, vertices}];
    if (!it)
        it =
            std::make_unique<Moment>(meets ? test::folded_sheet(vertices) : draped_sheet(vertices));
    return *it;
}

void step(benchmark::State& state) {
    const Moment& now = moment(state.range(0) != 0, static_cast<int>(state.range(1)));
    ClothStepper stepper(now.scene.garment, solver(state.range(2) != 0 ? thickness : 0.0));
    // A few frames in a row, as an animation has them: each starts where the last one ended.
    ClothState moving;
    int left = 0;
    for (auto _ : state) {
        if (left == 0) {
            state.PauseTiming();
            moving = now.state;
            stepper.step(now.scene.boundary, dt, moving);
            left = frames_in_a_row;
            state.ResumeTiming();
        }
        stepper.step(now.scene.boundary, dt, moving);
        --left;
    }
}

void pairs(benchmark::State& state) {
    const Moment& now = moment(state.range(0) != 0, static_cast<int>(state.range(1)));
    SelfProximity proximity(now.scene.garment, thickness);
    const Points motion = dt * now.state.v;
    for (auto _ : state) proximity.find(now.state.x, motion, 1.5 * thickness, 1);
    // The spread of zeros, over their mean, would be NaN, which JSON has not.
    if (!proximity.pairs().empty())
        state.counters["pairs"] = static_cast<double>(proximity.pairs().size());
}

void crossings(benchmark::State& state) {
    const Moment& now = moment(state.range(0) != 0, static_cast<int>(state.range(1)));
    SelfCrossings search(now.scene.garment);
    const Points end = now.state.x + dt * now.state.v;
    // From the same start a search looks only at what goes elsewhere.
    const std::array<Points, 2> starts = {now.state.x, now.state.x.array() + 1e-9};
    size_t next = 0;
    for (auto _ : state) search.find(starts[next++ % 2], end, 1);
}

void tangles(benchmark::State& state) {
    const Moment& now = moment(state.range(0) != 0, static_cast<int>(state.range(1)));
    SelfTangles search(now.scene.garment);
    for (auto _ : state) search.find(now.state.x, 1);
}

#define CLOTH_LAYER_BENCHMARK(function)       \
    BENCHMARK(function)                       \
        ->ArgsProduct({{0, 1}, {1000, 4000}}) \
        ->ArgNames({"meets", "vertices"})     \
        ->Unit(benchmark::kMillisecond)
BENCHMARK(step)
    ->ArgsProduct({{0, 1}, {1000, 4000}, {0, 1}})
    ->ArgNames({"meets", "vertices", "self_contact"})
    ->Unit(benchmark::kMillisecond);
CLOTH_LAYER_BENCHMARK(pairs);
CLOTH_LAYER_BENCHMARK(crossings);
CLOTH_LAYER_BENCHMARK(tangles);

}  // namespace
}  // namespace cloth

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::AddCustomContext("commit", cloth::build_commit());
    benchmark::AddCustomContext("machine", cloth::machine_name());
    benchmark::AddCustomContext("threads", "1");
    benchmark::RunSpecifiedBenchmarks();
}
