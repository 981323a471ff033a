#include "demos/speed_error/torch_backend.h"

#include <ATen/Parallel.h>

#include "gnn/train/torch_predictor.h"

namespace cloth {

TorchMaker torch_backend(int threads) {
    at::set_num_threads(threads);
    return [](const Weights& weights) { return make_torch_predictor(weights); };
}

}  // namespace cloth
