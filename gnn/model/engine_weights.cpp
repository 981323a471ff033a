#include "gnn/model/engine_weights.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "data/core/errors.h"
#include "gnn/model/weights_check.h"

namespace cloth {

/// Appends tensors to one array, panels in bfloat16 to another. Walks the network twice: once to
/// count, once to copy, so that pointers into the arrays stay valid.
class EngineWeights::Packer {
 public:
    Packer(const Weights& weights, Precision precision)
        : m_weights(weights), m_precision(precision) {}

    /// What was counted is allocated; the next walk copies.
    void allocate(AlignedBuffer& numbers, AlignedHalves& rounded) {
        numbers.resize(m_count);
        rounded.resize(m_rounded_count);
        m_numbers = numbers.data();
        m_rounded = rounded.data();
        m_copies = true;
        m_count = m_rounded_count = 0;
    }

    const float* values(const std::string& name) {
        const std::vector<float>& data = m_weights.tensor(name).data;
        float* to = take(data.size());
        if (to) std::copy(data.begin(), data.end(), to);
        return to;
    }

    Panels panels(const std::string& name) {
        const WeightTensor& tensor = m_weights.tensor(name);
        return packed(tensor.data.size(), [&tensor](auto* to) {
            pack_panels(tensor.data.data(), tensor.shape[0], tensor.shape[1], to);
        });
    }

    Statistics statistics(const std::string& name) {
        Statistics result{};
        result.mean = values("statistics." + name + ".mean");
        const std::vector<float>& deviation =
            m_weights.tensor("statistics." + name + ".deviation").data;
        float* inverse = take(deviation.size());
        for (size_t k = 0; inverse && k < deviation.size(); ++k) inverse[k] = 1.0f / deviation[k];
        result.inverse_deviation = inverse;
        return result;
    }

    MessageBlockWeights block(const std::string& name, const std::vector<std::string>& inputs) {
        MessageBlockWeights w;
        w.width = m_weights.config.width;
        std::vector<std::vector<float>> padded;
        for (const std::string& input : inputs) {
            const WeightTensor& tensor = m_weights.tensor(name + ".first." + input + ".weight");
            padded.push_back(padded_rows(tensor));
            w.in[w.inputs] = static_cast<int>(padded.back().size()) / w.width;
            w.w1[w.inputs++] = padded.back().data();
        }
        w.w2 = m_weights.tensor(name + ".hidden.1.weight").data.data();
        w.w3 = m_weights.tensor(name + ".output.weight").data.data();
        w.panels = packed(block_panel_count(w), [&w](auto* to) { pack_block(w, to); });
        std::fill(std::begin(w.w1), std::end(w.w1), nullptr);
        w.w2 = w.w3 = nullptr;
        w.b1 = values(name + ".first.bias");
        w.b2 = values(name + ".hidden.1.bias");
        w.b3 = values(name + ".output.bias");
        w.gamma = values(name + ".norm.weight");
        w.beta = values(name + ".norm.bias");
        return w;
    }

 private:
    /// Zero columns fill up to a multiple of 16.
    static std::vector<float> padded_rows(const WeightTensor& tensor) {
        const int rows = tensor.shape[0], columns = tensor.shape[1],
                  wide = (columns + 15) / 16 * 16;
        std::vector<float> result(static_cast<size_t>(rows) * static_cast<size_t>(wide), 0.0f);
        for (int r = 0; r < rows; ++r)
            std::copy_n(tensor.data.begin() + r * columns, columns, result.begin() + r * wide);
        return result;
    }

    static size_t padded(size_t count) { return (count + 31) / 32 * 32; }  // whole cache lines

    float* take(size_t count) {
        const size_t first = m_count;
        m_count += padded(count);
        return m_copies ? m_numbers + first : nullptr;
    }

    /// Room for panels in the precision asked for; `pack` fills it.
    template <typename Pack>
    Panels packed(size_t count, const Pack& pack) {
        if (m_precision == Precision::float32) {
            float* to = take(count);
            if (to) pack(to);
            return to;
        }
        const size_t first = m_rounded_count;
        m_rounded_count += padded(count);
        if (!m_copies) return {};
        pack(m_rounded + first);
        return m_rounded + first;
    }

    const Weights& m_weights;
    const Precision m_precision;
    float* m_numbers = nullptr;
    Bfloat16* m_rounded = nullptr;
    size_t m_count = 0, m_rounded_count = 0;
    bool m_copies = false;
};

static std::vector<int> columns_called(const std::string& prefix) {
    std::vector<int> columns;
    int column = 0;
    for (const FeatureGroup& group : world_layout())
        for (int k = 0; k < group.size; ++k, ++column)
            if (group.name.rfind(prefix, 0) == 0) columns.push_back(column);
    return columns;
}

EngineWeights::EngineWeights(const Weights& weights, Precision precision)
    : m_config(weights.config),
      m_name(weights.solver_name()),
      m_precision(precision),
      m_relative_columns(columns_called("relative")) {
    m_config.check();
    if (m_config.width % 16 != 0 || m_config.hidden_layers != 2)
        throw ArgumentError("weights of '" + m_name + "'",
                            "have width " + std::to_string(m_config.width) + " and " +
                                std::to_string(m_config.hidden_layers) + " hidden layers",
                            "the engine takes widths that are multiples of 16 and two hidden "
                            "layers; run others with LibTorch");
    const TensorProblem problem = find_problem(weights);
    if (!problem.place.empty())
        throw ArgumentError("weights of '" + m_name + "', " + problem.place, problem.text,
                            "give the tensors of parameter_shapes() and statistics_shapes()");
    Packer packer(weights, precision);
    const auto walk = [&] {
        const auto encoder = [&packer](const std::string& name, const std::string& statistics) {
            return Encoder{packer.block("encoder." + name, {"features"}),
                           packer.statistics(statistics)};
        };
        m_node = encoder("node", "node");
        m_edges.assign(static_cast<size_t>(coarsest_level(m_config.level_schedule)) + 1, {});
        for (const int level : m_config.used_levels())
            m_edges[static_cast<size_t>(level)] = encoder(level_name("edge", level), "edge");
        m_world = encoder("world", "world");
        m_body = encoder("body", "body");
        m_steps.clear();
        for (int k = 0; k < m_config.steps; ++k) {
            const std::string name = "step." + std::to_string(k);
            Step step{};
            std::vector<std::string> inputs = {"node"};
            for (const int level : m_config.levels(k)) {
                const std::string edges = name + "." + level_name("edge", level);
                step.edges.push_back({packer.block(edges, {"edge"}),
                                      packer.panels(edges + ".first.receiver.weight"),
                                      packer.panels(edges + ".first.sender.weight")});
                inputs.push_back(level_name("mesh", level));
            }
            if (m_config.has_world(k)) {
                step.world = packer.block(name + ".world", {"edge", "receiver", "sender"});
                inputs.push_back("world");
            }
            step.node = packer.block(name + ".node", inputs);
            m_steps.push_back(step);
        }
        m_decoder.first = packer.panels("decoder.first.node.weight");
        m_decoder.first_bias = packer.values("decoder.first.bias");
        m_decoder.hidden = packer.panels("decoder.hidden.1.weight");
        m_decoder.hidden_bias = packer.values("decoder.hidden.1.bias");
        m_decoder.output = packer.values("decoder.output.weight");
        m_decoder.output_bias = packer.values("decoder.output.bias");
    };
    walk();
    packer.allocate(m_numbers, m_rounded);
    walk();
}

}  // namespace cloth
