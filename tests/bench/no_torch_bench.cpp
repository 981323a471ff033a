#include "tests/bench/torch_bench.h"

namespace cloth::test {

void register_torch(const std::string&, const ModelConfig&, std::function<const TshirtMoment*()>,
                    std::function<void(benchmark::State&, double)>) {
}

}  // namespace cloth::test
