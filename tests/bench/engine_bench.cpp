// The network in the engine: what one evaluation costs, and how near that is to what the processor
// can do.
//
//     build/release/tests/bench/engine_bench --benchmark_enable_random_interleaving=true
//         --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
//
// Counters: peak_MB is what the process grew by at most until the first evaluation was done,
// loading included (run one benchmark alone to be sure that nothing is reused); weights, topology
// and workspace are what stays. GFLOP/s of the matrix products (nothing else counts as work), and
// `of_peak`, the share of the fused multiply-add peak that the same number of cores reached at the
// start of this run: float32's peak, which bfloat16 can exceed. `error` of bfloat16 is the relative
// RMS difference from float32 of the predicted accelerations. With LibTorch the same networks run
// there too, in the same process: compare within one run.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <random>

#include "data/core/paths.h"
#include "demos/provenance/provenance.h"
#include "gnn/model/engine.h"
#include "gnn/model/make_cloth.h"
#include "gnn/model/message_block.h"
#include "tests/bench/network_scene.h"
#include "tests/bench/peak.h"
#include "tests/bench/peak_memory.h"
#include "tests/bench/torch_bench.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::test {
namespace {

const TshirtMoment& moment() {
    static const TshirtMoment instance;
    return instance;
}

double peak(int threads) {
    static const double one = measured_peak(1), two = measured_peak(2);
    return threads == 1 ? one : two;
}

ModelConfig config_of(const std::string& variant, int width) {
    ModelConfig config = ModelConfig::variant_named(variant);
    config.width = width;
    return config;
}

void report(benchmark::State& state, double flops, double of_peak) {
    state.counters["GFLOP/s"] = benchmark::Counter(
        1e-9 * flops, benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::kIs1000);
    state.counters["of_peak"] =
        benchmark::Counter(flops / of_peak, benchmark::Counter::kIsIterationInvariantRate);
}

/// Matrices of random numbers and the row tables of an edge update with six edges per vertex.
struct BlockData {
    explicit BlockData(int width) : d(static_cast<size_t>(width)) {
        std::mt19937 random(3);
        std::normal_distribution<float> normal(0.0f, 0.2f);
        for (auto* values : {&w1, &w2, &w3}) values->resize(d * d);
        for (auto* values : {&bias, &gamma}) values->resize(d);
        x.resize(rows * d);
        for (auto* values : {&p, &q, &sum}) values->resize(vertices * d);
        for (auto* values : {&w1, &w2, &w3, &bias, &gamma, &x, &p, &q})
            for (float& value : *values) value = normal(random);
        for (int r = 0; r < rows; ++r) {
            receivers.push_back(r / 6);
            senders.push_back(static_cast<int>(random() % vertices));
        }
    }
    static constexpr int vertices = 192, rows = 6 * vertices;
    size_t d;
    AlignedBuffer w1, w2, w3, bias, gamma, x, p, q, sum;
    std::vector<int> receivers, senders;
};

MessageBlockWeights weights_of(const BlockData& data) {
    MessageBlockWeights weights;
    weights.width = weights.in[0] = static_cast<int>(data.d);
    weights.inputs = 1;
    weights.w1[0] = data.w1.data();
    weights.w2 = data.w2.data();
    weights.w3 = data.w3.data();
    weights.b1 = weights.b2 = weights.b3 = weights.beta = data.bias.data();
    weights.gamma = data.gamma.data();
    return weights;
}

template <typename Buffer>
void edge_block(benchmark::State& state) {
    BlockData data(static_cast<int>(state.range(0)));
    MessageBlockWeights weights = weights_of(data);
    MessageBlockRows rows;
    rows.rows = BlockData::rows;
    rows.x[0] = data.x.data();
    rows.products = 2;
    rows.p[0] = data.p.data();
    rows.p_index[0] = rows.sum_index = data.receivers.data();
    rows.p[1] = data.q.data();
    rows.p_index[1] = data.senders.data();
    rows.sum_scale = 1e-6f;
    Buffer panels(block_panel_count(weights));
    pack_block(weights, panels.data());
    weights.panels = panels.data();
    MessageBlockScratch scratch;
    AlignedBuffer out(data.x.size());
    for (auto _ : state) {
        message_block_forward(weights, rows, out.data(), data.sum.data(), scratch);
        benchmark::ClobberMemory();
    }
    report(state, 6.0 * BlockData::rows * static_cast<double>(data.d * data.d), peak(1));
}
BENCHMARK_TEMPLATE(edge_block, AlignedBuffer)
    ->RangeMultiplier(2)
    ->Range(16, 128)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(edge_block, AlignedHalves)
    ->RangeMultiplier(2)
    ->Range(16, 128)
    ->Unit(benchmark::kMicrosecond);

std::unique_ptr<Engine> make_engine(const Weights& weights, Precision precision, int threads) {
    return std::make_unique<Engine>(std::make_shared<const EngineWeights>(weights, precision),
                                    EngineSettings{threads});
}

double difference_from_float32(const Weights& weights, const NetworkInput& input,
                               const Points& actual) {
    Points expected;
    make_engine(weights, Precision::float32, 2)->predict(input.graph, input.features, expected);
    return (actual - expected).norm() / expected.norm();
}

void network(benchmark::State& state, const std::function<Weights()>& load, Precision precision,
             int threads) {
    const ModelConfig config = load().config;
    const NetworkInput input(moment(), config);
    std::unique_ptr<Engine> running;
    Points out;
    const double peak_mb = peak_memory_of([&] {
        running = make_engine(load(), precision, threads);
        running->predict(input.graph, input.features, out);
    });
    Engine& engine = *running;
    for (auto _ : state) engine.predict(input.graph, input.features, out);
    report(state, network_flops(config, input.graph, input.features).total(), peak(threads));
    state.counters["peak_MB"] = peak_mb;
    const EngineMemory memory = engine.memory();
    state.counters["weights_MB"] = 1e-6 * static_cast<double>(memory.weights);
    state.counters["topology_MB"] = 1e-6 * static_cast<double>(memory.topology);
    state.counters["workspace_MB"] = 1e-6 * static_cast<double>(memory.workspace);
    if (precision == Precision::bfloat16)
        state.counters["error"] = difference_from_float32(load(), input, out);
}

/// engine/... and engine-bf16/..., on one thread and on two.
void register_engine(const std::string& name, const std::function<Weights()>& load) {
    for (const Precision precision : {Precision::float32, Precision::bfloat16})
        for (const int threads : {1, 2}) {
            const std::string engine = precision == Precision::float32 ? "engine/" : "engine-bf16/";
            benchmark::RegisterBenchmark(
                (engine + name + "/threads:" + std::to_string(threads)).c_str(),
                [=](benchmark::State& state) { network(state, load, precision, threads); })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
        }
}

/// One whole frame of the learned stepper by stage; refinement as shipped and none.
void frame(benchmark::State& state, const ModelConfig& config, int refine) {
    const auto made = make_cloth(
        moment().garment, std::make_shared<Engine>(random_weights(config), EngineSettings{2}),
        ClothStepperSettings::plain(IterationLimits::exactly(refine)));
    Stepper& stepper = *made;
    StageTimes times;
    for (auto _ : state) {
        ClothState copy = moment().state;
        const StepReport step = stepper.step(moment().boundary, config.dt, copy);
        times += step.times;
    }
    const auto mean = [](double total) {
        return benchmark::Counter(total, benchmark::Counter::kAvgIterations);
    };
    state.counters["proximity_ms"] = mean(times.proximity);
    state.counters["features_ms"] = mean(times.features);
    state.counters["network_and_refinement_ms"] = mean(times.solve);
    state.counters["contact_ms"] = mean(times.contact);
}

void register_networks() {
    for (const std::string& variant : ModelConfig::variant_names())
        for (const int width : {32, 64, 128}) {
            const ModelConfig config = config_of(variant, width);
            const std::string name = variant + "/" + std::to_string(width);
            register_engine(name, [=] { return random_weights(config); });
            register_torch(
                "libtorch/" + name, config, [] { return &moment(); },
                [](benchmark::State& state, double flops) { report(state, flops, peak(2)); });
        }
    for (const char* name : {"baseline", "sampling", "reduction", "fast", "small"})
        register_engine(std::string("shipped/") + name, [=] {
            return Weights::load(asset_path(std::string("weights/") + name + ".safetensors"));
        });
    for (const int refine : {0, 10})
        benchmark::RegisterBenchmark(
            ("frame/fast/32/refine:" + std::to_string(refine)).c_str(),
            [=](benchmark::State& state) { frame(state, config_of("fast", 32), refine); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
}

}  // namespace
}  // namespace cloth::test

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    using namespace cloth::test;
    std::printf("fused multiply-add peak: %.0f GFLOP/s on one core, %.0f on two\n", 1e-9 * peak(1),
                1e-9 * peak(2));
    for (const int d : {32, 64, 128})
        std::printf("Eigen's product 4096x%dx%d: %.0f GFLOP/s on one core\n", d, d,
                    1e-9 * plain_product(4096, d, d));
    benchmark::AddCustomContext("commit", cloth::build_commit());
    benchmark::AddCustomContext("machine", cloth::machine_name());
    benchmark::AddCustomContext("threads", "1 and 2");
    register_networks();
    benchmark::RunSpecifiedBenchmarks();
}
