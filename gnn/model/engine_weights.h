#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gnn/model/message_block.h"
#include "gnn/model/weights.h"

namespace cloth {

/// Trained weights as the engine reads them: one block of memory, matrices in panels. Constant;
/// any number of engines share one. Their precision is the engines' precision.
///
///     const auto weights = std::make_shared<const EngineWeights>(Weights::load(file));
///     Engine shirt(weights), trousers(weights);
///
/// Precision::bfloat16 halves them, and the time where the processor has AVX512-BF16. What that
/// does to an acceleration is a matter of the weights; gnn/model/RESULTS.md has the shipped ones.
class EngineWeights {
 public:
    /// Copies what it needs. @throws ArgumentError if the width is no multiple of 16, there are
    /// not two hidden layers, or a tensor is missing, misshaped or not finite
    explicit EngineWeights(const Weights& weights, Precision precision = Precision::float32);
    EngineWeights(const EngineWeights&) = delete;
    EngineWeights& operator=(const EngineWeights&) = delete;

    struct Statistics {
        const float *mean, *inverse_deviation;
    };
    struct Encoder {
        MessageBlockWeights block;  ///< input filled up to a multiple of 16
        Statistics statistics;
    };
    /// Messages along the edges of a level.
    struct Edges {
        MessageBlockWeights block;
        Panels receiver, sender;  ///< of the split first layer's A and B
    };
    struct Step {
        std::vector<Edges> edges;  ///< in the order of ModelConfig::levels(k)
        MessageBlockWeights world, node;
    };
    struct Decoder {
        Panels first, hidden;
        const float *first_bias, *hidden_bias;
        const float *output, *output_bias;  ///< (3 x D), (3)
    };

    const ModelConfig& config() const { return m_config; }
    const std::string& name() const { return m_name; }  ///< Weights::solver_name()
    Precision precision() const { return m_precision; }
    const Encoder& node_encoder() const { return m_node; }
    /// @param level  one in use
    const Encoder& edge_encoder(int level) const { return m_edges[static_cast<size_t>(level)]; }
    const Encoder& world_encoder() const { return m_world; }
    const Encoder& body_encoder() const { return m_body; }
    const Step& step(size_t k) const { return m_steps[k]; }
    const Decoder& decoder() const { return m_decoder; }

    /// Columns of the world edges' features that change sign if seen from the other end.
    const std::vector<int>& relative_columns() const { return m_relative_columns; }

    size_t bytes() const {
        return sizeof(float) * m_numbers.capacity() + sizeof(Bfloat16) * m_rounded.capacity();
    }

 private:
    class Packer;

    ModelConfig m_config;
    std::string m_name;
    Precision m_precision;
    AlignedBuffer m_numbers;
    AlignedHalves m_rounded;  ///< panels in bfloat16
    Encoder m_node, m_world, m_body;
    std::vector<Encoder> m_edges;  ///< per level; blank for one that is not in use
    std::vector<Step> m_steps;
    Decoder m_decoder;
    std::vector<int> m_relative_columns;
};

}  // namespace cloth
