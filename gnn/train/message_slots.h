#pragma once

#include <torch/torch.h>

#include "gnn/model/message_block.h"
#include "gnn/train/fused_block.h"

/// What the differentiable message blocks of CPU and GPU share: how their arguments are listed.
namespace cloth::message_slots {

// Order of the tensors in an operation's argument list.
enum Slot {
    x0,  // x of MessageBlockRows
    p0 = x0 + MessageBlockWeights::max_inputs,
    p1,
    w10,  // w1
    b1 = w10 + MessageBlockWeights::max_inputs,
    w2,
    b2,
    w3,
    b3,
    gamma,
    beta,
    slot_count
};
constexpr int max_inputs = MessageBlockWeights::max_inputs;

/// LibTorch's custom functions take no undefined tensors: an absent one is empty.
inline bool is_absent(const torch::Tensor& tensor) {
    return !tensor.defined() || tensor.numel() == 0;
}

/// Null: absent.
inline float* data_of(const torch::Tensor& tensor) {
    return is_absent(tensor) ? nullptr : tensor.data_ptr<float>();
}

/// Function::apply() on tensors in this order, and `call`.
template <typename Function, typename Call>
FusedOutput apply(const std::vector<torch::Tensor>& x, const std::vector<torch::Tensor>& products,
                  const FusedWeights& weights, const Call& call) {
    const torch::Tensor absent = torch::empty({0}, weights.w2.options().requires_grad(false));
    const auto input = [&absent](const std::vector<torch::Tensor>& list, size_t k) {
        return k < list.size() ? list[k] : absent;
    };
    const auto present = [&absent](const torch::Tensor& tensor) {
        return tensor.defined() ? tensor : absent;
    };
    const auto result =
        Function::apply(input(x, 0), input(x, 1), input(x, 2), input(x, 3), input(products, 0),
                        input(products, 1), weights.w1[0], present(weights.w1[1]),
                        present(weights.w1[2]), present(weights.w1[3]), weights.b1, weights.w2,
                        weights.b2, weights.w3, weights.b3, weights.gamma, weights.beta, call);
    return {call->with_out ? result[0] : torch::Tensor(), result[1]};
}

}  // namespace cloth::message_slots
