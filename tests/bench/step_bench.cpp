// A step of the T-shirt, stage by stage: where its time goes.
//
//     build/release/tests/bench/step_bench --benchmark_enable_random_interleaving=true
//         --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
//
// The garment has 3,991 vertices and moves with the default body (26,756 faces) through 60 frames
// of motion 01_01; without assimp-testmodels it lies on a sphere. Each benchmark goes from frame to
// frame, as a stepper does. `per_vertex` is in nanoseconds. The argument is the number of threads.
//
// `floor_us` is what the stage's arithmetic takes at the peak of one core's multiply-adds, as
// measured at the start of this run (float32; half of it in double precision). `bytes` is what the
// stage reads and writes at least, each array once.

#include <benchmark/benchmark.h>
#include <omp.h>

#include "collision/proximity/limb_overlap.h"
#include "collision/proximity/obstacle_trees.h"
#include "collision/proximity/ridge_contacts.h"
#include "collision/response/contact_projection.h"
#include "data/core/paths.h"
#include "demos/provenance/provenance.h"
#include "gnn/model/make_cloth.h"
#include "gnn/physics/energy/elastic.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/guess.h"
#include "tests/bench/network_scene.h"
#include "tests/bench/peak.h"

namespace cloth::test {
namespace {

/// What a stage is given in a frame.
struct Moment {
    Boundary boundary;
    ClothState state;
    SurfaceContacts contacts;
    Points guess, solved;  ///< |V| x 3 (m): after three iterations, not projected yet
};

struct Recording {
    Garment garment;
    std::vector<Moment> moments;

    Recording() : garment(TshirtMotion::load_garment()) {
        TshirtMotion motion(garment);
        Proximity proximity;
        RidgeFinder ridges(garment);
        IncrementalPotential potential(garment);
        QuasiNewton solver(garment, IterationLimits::exactly(3));
        for (int frame = 0; frame < 60; ++frame) {
            Moment moment{motion.boundary(), motion.state(), {}, {}, {}};
            proximity.query(moment.state.x, moment.boundary, moment.contacts);
            ridges.find(proximity, moment.boundary, moment.state.x, moment.contacts,
                        StepEnd::start);
            potential.begin_step(moment.state, moment.boundary, moment.contacts, dt);
            starting_guess(garment, moment.state, moment.boundary, moment.contacts, dt,
                           PotentialSettings().contact_distance, moment.guess);
            moment.solved = moment.guess;
            solver.minimise(potential, moment.solved);
            moments.push_back(std::move(moment));
            motion.step();
        }
    }
};

const Recording& recording() {
    static const Recording instance;
    return instance;
}

/// Arithmetic and memory of a stage.
struct Work {
    double flops = 0.0;  ///< additions and multiplications
    double bytes = 0.0;
    bool doubles = true;
};

void report(benchmark::State& state, const Work& work) {
    static const double peak = measured_peak(1);  // float32
    state.counters["floor_us"] = 1e6 * work.flops / (work.doubles ? 0.5 * peak : peak);
    if (work.bytes > 0.0) state.counters["bytes"] = work.bytes;
}

/// Runs `work` on one moment after the other.
template <class Work>
void for_moments(benchmark::State& state, const Work& work) {
    omp_set_num_threads(static_cast<int>(state.range(0)));
    const auto& moments = recording().moments;
    size_t at = 0;
    for (auto _ : state) {
        work(moments[at]);
        at = (at + 1) % moments.size();
    }
    const auto vertices = static_cast<double>(recording().garment.vertex_count());
    state.counters["per_vertex"] =
        benchmark::Counter(1e-9 * vertices, benchmark::Counter::kIsIterationInvariantRate |
                                                benchmark::Counter::kInvert);
}

void fit_surfaces(const Moment& moment, ObstacleTrees& trees) {
    trees.begin_step();
    for (const Obstacle& obstacle : moment.boundary.obstacles)
        benchmark::DoNotOptimize(trees.surface(obstacle, StepEnd::end));
}

void fit_trees(benchmark::State& state) {
    ObstacleTrees trees;
    for_moments(state, [&](const Moment& moment) { fit_surfaces(moment, trees); });
}

/// Runs `work` with the trees fitted to the end of the step, outside of the measured time.
/// @param prepare  more that is not measured
template <class Prepare, class Work>
void for_fitted(benchmark::State& state, ObstacleTrees& trees, const Prepare& prepare,
                const Work& work) {
    for_moments(state, [&](const Moment& moment) {
        state.PauseTiming();
        fit_surfaces(moment, trees);
        prepare(moment);
        state.ResumeTiming();
        work(moment);
    });
}

/// The same with a potential that has begun the step.
template <class Prepare, class Work>
void for_begun(benchmark::State& state, IncrementalPotential& potential, const Prepare& prepare,
               const Work& work) {
    for_moments(state, [&](const Moment& moment) {
        state.PauseTiming();
        potential.begin_step(moment.state, moment.boundary, moment.contacts, dt);
        prepare(moment);
        state.ResumeTiming();
        work(moment);
    });
}

constexpr auto nothing = [](const Moment&) {};

void nearest_points(benchmark::State& state) {
    auto trees = std::make_shared<ObstacleTrees>();
    Proximity proximity({}, trees);
    SurfaceContacts contacts;
    for_fitted(state, *trees, nothing, [&](const Moment& moment) {
        proximity.query(moment.solved, moment.boundary, contacts, StepEnd::end);
    });
}

/// What the stepper does for limbs before a step. The trees are fitted, and the points at the start
/// have been searched for, as by the step before.
void limbs(benchmark::State& state) {
    auto trees = std::make_shared<ObstacleTrees>();
    Proximity proximity({}, trees);
    LimbOverlap overlap({}, trees, &proximity);
    SurfaceContacts contacts;
    const auto prepare = [&](const Moment& moment) {
        proximity.query(moment.state.x, moment.boundary, contacts);
    };
    for_fitted(state, *trees, prepare, [&](const Moment& moment) {
        benchmark::DoNotOptimize(&overlap.filter(moment.boundary, dt, moment.state));
    });
}

/// Nearest points included.
void contact_projection(benchmark::State& state) {
    auto trees = std::make_shared<ObstacleTrees>();
    Proximity proximity({}, trees);
    ContactProjection projection(recording().garment);
    SurfaceContacts contacts;
    Points x;
    for_fitted(
        state, *trees, [&](const Moment& moment) { x = moment.solved; },
        [&](const Moment& moment) {
            projection.resolve(proximity, moment.boundary, 5e-4, x, contacts);
        });
}

void ridges(benchmark::State& state) {
    Proximity proximity;
    RidgeFinder finder(recording().garment);
    SurfaceContacts contacts;
    for_moments(state, [&](const Moment& moment) {
        state.PauseTiming();
        proximity.query(moment.state.x, moment.boundary, contacts);
        state.ResumeTiming();
        finder.find(proximity, moment.boundary, moment.state.x, contacts, StepEnd::start);
    });
}

void begin_potential(benchmark::State& state) {
    IncrementalPotential potential(recording().garment);
    for_moments(state, [&](const Moment& moment) {
        potential.begin_step(moment.state, moment.boundary, moment.contacts, dt);
    });
}

void energy_gradient(benchmark::State& state) {
    IncrementalPotential potential(recording().garment);
    Points gradient;
    for_begun(state, potential, nothing, [&](const Moment& moment) {
        benchmark::DoNotOptimize(potential.value_gradient(moment.guess, gradient));
    });
}

void elastic_gradient(benchmark::State& state) {
    const ElasticEnergy energy(recording().garment);
    Points gradient;
    for_moments(state, [&](const Moment& moment) {
        benchmark::DoNotOptimize(energy.gradient(moment.guess, gradient));
    });
}

constexpr double point_bytes = 3 * sizeof(double);

/// On one thread, whatever the argument says.
/// @tparam flops, constants  of an element, as its loop has them
template <class Energy, int corners, int flops, int constants>
void elastic(benchmark::State& state, double elements) {
    const Energy energy(recording().garment);
    const auto vertices = static_cast<double>(recording().garment.vertex_count());
    Points gradient = Points::Zero(recording().garment.vertex_count(), 3);
    for_moments(state, [&](const Moment& moment) {
        benchmark::DoNotOptimize(energy.add_gradient(moment.guess, gradient));
    });
    const double element_bytes = corners * sizeof(int) + constants * sizeof(double);
    report(state, {flops * elements, 3 * point_bytes * vertices + element_bytes * elements});
}

void strain(benchmark::State& state) {
    elastic<StrainEnergy, 3, 92, 4>(state, recording().garment.face_count());
}

void bending(benchmark::State& state) {
    elastic<BendingEnergy, 4, 132, 2>(state,
                                      static_cast<double>(recording().garment.hinges().size()));
}

/// One solve of three right-hand sides with the constant matrix.
void matrix_solve(benchmark::State& state) {
    QuasiNewtonMatrix matrix(recording().garment);
    matrix.prepare(recording().garment, dt);
    SupernodalCholesky<double> factor;
    factor.factorise(matrix.matrix());
    Points out;
    for_moments(state, [&](const Moment& moment) { matrix.solve(moment.guess, out); });
    const auto numbers = static_cast<double>(factor.nonzeros());
    report(state, {2 * 2 * 3 * numbers, 2 * sizeof(double) * numbers});
}

/// One with contact in the matrix.
void contact_solve(benchmark::State& state) {
    const Garment& garment = recording().garment;
    IncrementalPotential potential(garment);
    QuasiNewtonMatrix matrix(garment);
    ContactHessian contacts;
    Points gradient, out;
    const auto prepare = [&](const Moment& moment) {
        potential.value_gradient(moment.guess, gradient);
        gradient = -gradient;
        matrix.prepare(garment, dt);
        contacts.begin_step(potential, matrix.row_of());
        matrix.deflate(moment.guess);
        contacts.linearise(potential, moment.guess);
    };
    for_begun(state, potential, prepare, [&](const Moment&) {
        matrix.solve(gradient, contacts, QuasiNewtonSettings().contact_cg_iterations, out);
    });
}

template <int iterations>
void minimise(benchmark::State& state) {
    IncrementalPotential potential(recording().garment);
    QuasiNewton solver(recording().garment, IterationLimits::exactly(iterations));
    Points x;
    for_begun(
        state, potential, [&](const Moment& moment) { x = moment.guess; },
        [&](const Moment&) { solver.minimise(potential, x); });
}

/// The network, and what it is given in a frame.
struct SmallNetwork {
    Engine engine;
    ClothGraph graph;
    FeatureBuilder builder;
    IncrementalPotential potential;
    Features features;
    PotentialValue at_guess;

    SmallNetwork()
        : engine(Weights::load(asset_path("weights/small.safetensors"))),
          graph(build_cloth_graph(recording().garment, engine.config().graph_settings())),
          builder(recording().garment, graph, engine.config().features),
          potential(recording().garment) {}

    void build(const Moment& moment) {
        builder.build(moment.state, moment.boundary, potential, moment.guess, features, &at_guess);
    }
};

void features(benchmark::State& state) {
    SmallNetwork small;
    for_begun(state, small.potential, nothing, [&](const Moment& moment) { small.build(moment); });
}

void network(benchmark::State& state) {
    SmallNetwork small;
    Points out;
    for_begun(
        state, small.potential, [&](const Moment& moment) { small.build(moment); },
        [&](const Moment&) { small.engine.predict(small.graph, small.features, out); });
    const NetworkFlops flops = network_flops(small.engine.config(), small.graph, small.features);
    report(state, {flops.total(), 0.0, false});
}

/// Whole steps, one after the other: the cloth goes its own way through the recorded frames.
/// @tparam iterations  after the network, or alone
template <bool learned, int iterations>
void whole_step(benchmark::State& state) {
    ClothSettings settings;
    settings.step = StepSettings::whole(IterationLimits::exactly(iterations));
    settings.guard.max_substeps = 1;
    if (learned)
        settings.weights = std::make_shared<const EngineWeights>(
            Weights::load(asset_path("weights/small.safetensors")));
    const auto stepper = make_cloth(recording().garment, settings);
    stepper->prepare(dt);
    ClothState cloth = recording().moments.front().state;
    for (size_t k = 0; k < 5; ++k) stepper->step(recording().moments[k].boundary, dt, cloth);
    for_moments(state, [&](const Moment& moment) {
        if (&moment == &recording().moments.front()) cloth = moment.state;
        stepper->step(moment.boundary, dt, cloth);
    });
}

#define STAGE(...) \
    BENCHMARK(__VA_ARGS__)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMicrosecond)
STAGE(fit_trees);
STAGE(nearest_points);
STAGE(limbs);
STAGE(contact_projection);
STAGE(ridges);
STAGE(begin_potential);
STAGE(energy_gradient);
STAGE(elastic_gradient);
STAGE(strain);
STAGE(bending);
STAGE(matrix_solve);
STAGE(contact_solve);
STAGE(minimise<3>);
STAGE(minimise<10>);
STAGE(features);
STAGE(network);
STAGE(whole_step<false, 3>)->MinTime(1.5);  // s: all frames
STAGE(whole_step<false, 10>)->MinTime(1.5);
STAGE(whole_step<true, 3>)->MinTime(1.5);

}  // namespace
}  // namespace cloth::test

int main(int count, char** arguments) {
    benchmark::Initialize(&count, arguments);
    if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
    benchmark::AddCustomContext("commit", cloth::build_commit());
    benchmark::AddCustomContext("machine", cloth::machine_name());
    benchmark::AddCustomContext("threads", "1 and 2");
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
