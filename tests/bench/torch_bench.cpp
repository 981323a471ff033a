#include "tests/bench/torch_bench.h"

#include "gnn/train/torch_predictor.h"
#include "tests/bench/peak_memory.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::test {

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
}

}  // namespace cloth::test
