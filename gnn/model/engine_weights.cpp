#include "gnn/model/engine_weights.h"

#include <algorithm>
#include <string>

#include "data/errors.h"

namespace cloth {

/// Appends tensors to one array. Walks the network twice: once to count, once to copy, so that
/// pointers into the array stay valid.
class EngineWeights::Packer {
 public:
    Packer(const Weights& weights, AlignedBuffer* numbers)
        : m_weights(weights), m_numbers(numbers) {}

    size_t count() const { return m_count; }

    const float* values(const std::string& name) {
        const std::vector<float>& data = m_weights.tensor(name).data;
        float* to = take(data.size());
        if (to) std::copy(data.begin(), data.end(), to);
        return to;
    }

    const float* panels(const std::string& name) {
        const WeightTensor& tensor = m_weights.tensor(name);
        float* to = take(tensor.data.size());
        if (to) pack_panels(tensor.data.data(), tensor.shape[0], tensor.shape[1], to);
        return to;
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
        float* to = take(block_panel_count(w));
        if (to) pack_block(w, to);
        w.panels = to;
        w.w1[0] = w.w1[1] = w.w1[2] = w.w2 = w.w3 = nullptr;
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

    float* take(size_t count) {
        const size_t first = m_count;
        m_count += (count + 15) / 16 * 16;
        return m_numbers ? m_numbers->data() + first : nullptr;
    }

    const Weights& m_weights;
    AlignedBuffer* m_numbers;
    size_t m_count = 0;
};

static std::vector<int> columns_called(const std::string& prefix) {
    std::vector<int> columns;
    int column = 0;
    for (const FeatureGroup& group : world_layout())
        for (int k = 0; k < group.size; ++k, ++column)
            if (group.name.rfind(prefix, 0) == 0) columns.push_back(column);
    return columns;
}

EngineWeights::EngineWeights(const Weights& weights)
    : m_config(weights.config), m_relative_columns(columns_called("relative")) {
    if (m_config.width % 16 != 0 || m_config.hidden_layers != 2)
        throw ArgumentError("weights of '" + m_config.variant + "'",
                            "have width " + std::to_string(m_config.width) + " and " +
                                std::to_string(m_config.hidden_layers) + " hidden layers",
                            "the engine takes widths that are multiples of 16 and two hidden "
                            "layers; run others with LibTorch");
    const auto pack = [&](Packer packer) {
        const auto encoder = [&packer](const std::string& name) {
            return Encoder{packer.block("encoder." + name, {"features"}), packer.statistics(name)};
        };
        m_node = encoder("node");
        m_edge = encoder("edge");
        m_world = encoder("world");
        m_body = encoder("body");
        m_steps.clear();
        for (int k = 0; k < m_config.steps; ++k) {
            const std::string name = "step." + std::to_string(k);
            Step step{};
            step.edge = packer.block(name + ".edge", {"edge"});
            step.receiver = packer.panels(name + ".edge.first.receiver.weight");
            step.sender = packer.panels(name + ".edge.first.sender.weight");
            std::vector<std::string> inputs = {"node", "mesh"};
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
        return packer.count();
    };
    m_numbers.resize(pack(Packer(weights, nullptr)));
    pack(Packer(weights, &m_numbers));
}

}  // namespace cloth
