#include "gnn/train/message_op.h"

#include <utility>

#include "gnn/train/cuda/cuda_block.h"

namespace cloth {

using torch::Tensor;

static Tensor to_index(const std::vector<int>& index, torch::Device device) {
    if (index.empty()) return Tensor();
    return torch::tensor(std::vector<std::int64_t>(index.begin(), index.end()), torch::kInt64)
        .to(device);
}

MessageTable::MessageTable(FusedRows fused, torch::Device device)
    : x_index(to_index(fused.x_index, device)),
      product_index{to_index(fused.product_index[0], device),
                    to_index(fused.product_index[1], device)},
      sum_index(to_index(fused.sum_index, device)) {
    rows = std::make_shared<const FusedRows>(std::move(fused));
}

const Tensor& RowShifts::spread(const std::vector<int>& shifts, const std::vector<int>& counts) {
    Tensor& rows = m_known[{shifts, counts}];
    if (rows.defined()) return rows;
    std::vector<std::int64_t> values;
    for (size_t k = 0; k < counts.size(); ++k)
        values.insert(values.end(), static_cast<size_t>(counts[k]), shifts[k]);
    rows = torch::tensor(values, torch::kInt64).to(m_device);
    return rows;
}

MessageTable::MessageTable(const std::vector<const MessageTable*>& tables,
                           const std::vector<Shift>& shifts, RowShifts& row_shifts) {
    const auto join = [&](const auto& index_of, int Shift::*shift) {
        std::vector<Tensor> parts;
        std::vector<int> added, counts;
        for (size_t k = 0; k < tables.size(); ++k) {
            const Tensor& part = index_of(*tables[k]);
            if (!part.defined()) continue;
            parts.push_back(part);
            added.push_back(shifts[k].*shift);
            counts.push_back(static_cast<int>(part.size(0)));
        }
        return parts.empty() ? Tensor() : torch::cat(parts).add_(row_shifts.spread(added, counts));
    };
    x_index = join([](const MessageTable& t) -> const Tensor& { return t.x_index; }, &Shift::x);
    for (size_t p = 0; p < 2; ++p)
        product_index[p] =
            join([p](const MessageTable& t) -> const Tensor& { return t.product_index[p]; },
                 &Shift::product);
    sum_index =
        join([](const MessageTable& t) -> const Tensor& { return t.sum_index; }, &Shift::sum);
    FusedRows all;
    all.sum_scale = tables.front()->rows->sum_scale;
    for (const MessageTable* table : tables) {
        all.rows += table->rows->rows;
        all.sums += table->rows->sums;
    }
    const auto copy = [](const Tensor& index, std::vector<int>& to) {
        if (!index.defined() || !index.device().is_cpu()) return;
        const auto* data = index.data_ptr<std::int64_t>();
        to.assign(data, data + index.numel());
    };
    copy(x_index, all.x_index);
    copy(product_index[0], all.product_index[0]);
    copy(product_index[1], all.product_index[1]);
    copy(sum_index, all.sum_index);
    rows = std::make_shared<const FusedRows>(std::move(all));
}

Tensor mlp_tail(const MlpWeights& weights, const Tensor& first) {
    Tensor h = torch::relu(first);
    for (size_t k = 0; k < weights.hidden.size(); ++k)
        h = torch::relu(torch::linear(h, weights.hidden[k], weights.hidden_bias[k]));
    h = torch::linear(h, weights.output, weights.output_bias);
    if (!weights.norm.defined()) return h;
    return torch::layer_norm(h, {h.size(1)}, weights.norm, weights.norm_bias, 1e-5);
}

Tensor mlp(const MlpWeights& weights, const Tensor& input) {
    return mlp_tail(weights, torch::linear(input, weights.first[0], weights.first_bias));
}

static Tensor rows_of(const Tensor& matrix, const Tensor& index) {
    return index.defined() ? matrix.index_select(0, index) : matrix;
}

FusedOutput message_op_plain(const std::vector<Tensor>& x, const std::vector<int>& inputs,
                             const std::vector<Tensor>& products, const MlpWeights& weights,
                             const MessageTable& table, bool with_out) {
    Tensor first = weights.first_bias;
    for (size_t k = 0; k < x.size(); ++k) {
        const Tensor rows = rows_of(x[k], k == 0 ? table.x_index : Tensor());
        first = first + torch::mm(rows, weights.first[static_cast<size_t>(inputs[k])].t());
    }
    for (size_t k = 0; k < products.size(); ++k)
        first = first + rows_of(products[k], table.product_index[k]);
    const Tensor message = mlp_tail(weights, first);
    FusedOutput result;
    if (with_out)
        result.out =
            table.x_index.defined() ? x[0].index_add(0, table.x_index, message) : x[0] + message;
    const Tensor scaled = message * static_cast<double>(table.rows->sum_scale);
    const Tensor zero = torch::zeros({table.rows->sums, message.size(1)}, message.options());
    if (table.rows->sums > 0)
        result.sum =
            table.sum_index.defined() ? zero.index_add(0, table.sum_index, scaled) : scaled;
    return result;
}

FusedOutput message_op(const std::vector<Tensor>& x, const std::vector<int>& inputs,
                       const std::vector<Tensor>& products, const MlpWeights& weights,
                       const MessageTable& table, bool with_out) {
    const bool fits = weights.hidden.size() == 1 && weights.norm.defined();
    const auto takes = [&](const auto& supports) {
        return fits && supports(weights.output) && supports(x[0]);
    };
    const bool on_gpu = takes(cuda_block_supports);
    if (!on_gpu && !takes(fused_block_supports))
        return message_op_plain(x, inputs, products, weights, table, with_out);
    FusedWeights fused;
    for (size_t k = 0; k < x.size(); ++k)
        fused.w1[k] = weights.first[static_cast<size_t>(inputs[k])];
    fused.b1 = weights.first_bias;
    fused.w2 = weights.hidden[0];
    fused.b2 = weights.hidden_bias[0];
    fused.w3 = weights.output;
    fused.b3 = weights.output_bias;
    fused.gamma = weights.norm;
    fused.beta = weights.norm_bias;
    return on_gpu ? cuda_message_block(x, products, fused, table, with_out)
                  : fused_message_block(x, products, fused, table.rows, with_out);
}

}  // namespace cloth
