#include "data/core/errors.h"
#include "gnn/train/cuda/cuda_block.h"

namespace cloth {

bool cuda_block_supports(const torch::Tensor&) {
    return false;
}

FusedOutput cuda_message_block(const std::vector<torch::Tensor>&, const std::vector<torch::Tensor>&,
                               const FusedWeights&, const MessageTable&, bool) {
    throw ArgumentError("message block on a GPU", "is not built", "configure with CLOTH_CUDA=ON");
}

}  // namespace cloth
