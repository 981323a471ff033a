#pragma once

#include <torch/torch.h>

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "gnn/train/fused_block.h"

namespace cloth {

/// Parameters of a multilayer perceptron with a split first layer.
struct MlpWeights {
    std::vector<torch::Tensor> first;  ///< per input (D x inputs)
    torch::Tensor first_bias;
    std::vector<torch::Tensor> hidden, hidden_bias;      ///< per further hidden layer (D x D), (D)
    torch::Tensor output, output_bias, norm, norm_bias;  ///< norm undefined: no LayerNorm
};

/// A number per part, repeated for each of the part's rows: int64, on a device. The steps of a
/// network ask for the same ones again and again.
class RowShifts {
 public:
    explicit RowShifts(torch::Device device) : m_device(device) {}

    const torch::Tensor& spread(const std::vector<int>& shifts, const std::vector<int>& counts);

 private:
    torch::Device m_device;
    std::map<std::pair<std::vector<int>, std::vector<int>>, torch::Tensor> m_known;
};

/// Index tables of a message block on the device of its tensors; see FusedRows for the meaning.
struct MessageTable {
    /// What is added to the indices of one of several tables.
    struct Shift {
        int x = 0, product = 0, sum = 0;
    };

    explicit MessageTable(FusedRows rows, torch::Device device);
    /// Several tables one behind the other, as one. What is no index in one is none in all.
    /// @param shifts  per table
    MessageTable(const std::vector<const MessageTable*>& tables, const std::vector<Shift>& shifts,
                 RowShifts& row_shifts);

    std::shared_ptr<const FusedRows> rows;  ///< joined on a GPU: the numbers alone, no indices
    torch::Tensor x_index, product_index[2], sum_index;  ///< int64, undefined: row r
};

/// Everything after the first layer's sum: (rows x D) -> (rows x outputs).
torch::Tensor mlp_tail(const MlpWeights& weights, const torch::Tensor& first);

/// The whole perceptron on one input.
torch::Tensor mlp(const MlpWeights& weights, const torch::Tensor& input);

/// One message block (gnn/model/message_block.h) whose direct inputs x belong to the first-layer
/// weights numbered `inputs`. Takes the fused operation where it can, else LibTorch's own.
FusedOutput message_op(const std::vector<torch::Tensor>& x, const std::vector<int>& inputs,
                       const std::vector<torch::Tensor>& products, const MlpWeights& weights,
                       const MessageTable& table, bool with_out);

/// The same with LibTorch's operations alone: for other devices and types, and for the tests.
FusedOutput message_op_plain(const std::vector<torch::Tensor>& x, const std::vector<int>& inputs,
                             const std::vector<torch::Tensor>& products, const MlpWeights& weights,
                             const MessageTable& table, bool with_out);

}  // namespace cloth
