#include "tests/bench/torch_bench.h"

#include <torch/cuda.h>

#include "gnn/graph/graph_batch.h"
#include "gnn/train/torch_predictor.h"
#include "tests/bench/peak_memory.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::test {

/// Equal characters in one evaluation; `characters` counts them per second.
static void run_batch(benchmark::State& state, const TshirtMoment& moment,
                      const ModelConfig& config, const std::string& device, int characters) {
    const NetworkInput input(moment, config);
    const auto count = static_cast<size_t>(characters);
    const GraphBatch batch(std::vector<const ClothGraph*>(count, &input.graph));
    Features features;
    batch.gather(std::vector<const Features*>(count, &input.features), features);
    const auto predictor = make_torch_predictor(random_weights(config), device);
    Points out;
    predictor->predict(batch.graph(), features, out);
    for (auto _ : state) predictor->predict(batch.graph(), features, out);
    state.counters["characters"] =
        benchmark::Counter(characters, benchmark::Counter::kIsIterationInvariantRate);
}

void register_torch(const std::string& name, const ModelConfig& config,
                    std::function<const TshirtMoment*()> moment,
                    std::function<void(benchmark::State&, double flops)> report) {
    const auto run = [=](benchmark::State& state) {
        const NetworkInput input(*moment(), config);
        std::unique_ptr<Predictor> predictor;
        Points out;
        const double peak_mb = peak_memory_of([&] {
            predictor = make_torch_predictor(random_weights(config));
            predictor->predict(input.graph, input.features, out);
        });
        for (auto _ : state) predictor->predict(input.graph, input.features, out);
        report(state, network_flops(config, input.graph, input.features).total());
        state.counters["peak_MB"] = peak_mb;
    };
    benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond)->UseRealTime();
    if (config.width != 32) return;  // the trained networks'
    for (const char* device : {"cpu", "cuda"}) {
        if (device == std::string("cuda") && !torch::cuda::is_available()) continue;
        for (const int characters : {1, 4, 16}) {
            const auto batch = [=](benchmark::State& state) {
                run_batch(state, *moment(), config, device, characters);
            };
            const std::string full =
                name + "/device:" + device + "/characters:" + std::to_string(characters);
            benchmark::RegisterBenchmark(full.c_str(), batch)
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
        }
    }
}

}  // namespace cloth::test
