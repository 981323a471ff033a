#include "gnn/skinning/skinning_network.h"

#include <string>

namespace cloth {

static Eigen::Map<const Eigen::VectorXf> vector_of(const WeightTensor& tensor) {
    return {tensor.data.data(), static_cast<Eigen::Index>(tensor.data.size())};
}

SkinningNetwork::SkinningNetwork(const SkinningWeights& weights)
    : m_mean(vector_of(weights.tensor("input.mean")).cast<double>()),
      m_deviation(vector_of(weights.tensor("input.deviation")).cast<double>()),
      m_scale(weights.config.scale) {
    for (size_t k = 0; k <= weights.config.layers.size(); ++k) {
        const std::string name = "layer." + std::to_string(k);
        const WeightTensor& weight = weights.tensor(name + ".weight");
        m_layers.push_back(
            {Eigen::Map<const Matrix>(weight.data.data(), weight.shape[0], weight.shape[1]),
             vector_of(weights.tensor(name + ".bias")), Eigen::VectorXf::Zero(weight.shape[0])});
    }
}

void SkinningNetwork::evaluate(const VectorX& features, Points& displacement) {
    m_input = ((features - m_mean).array() / m_deviation.array())
                  .cast<float>()
                  .max(-most_deviations)
                  .min(most_deviations);
    const Eigen::VectorXf* input = &m_input;
    for (Layer& layer : m_layers) {
        layer.output = layer.bias;
        layer.output.noalias() += layer.weight * *input;
        if (&layer != &m_layers.back())
            layer.output = layer.output.array() / (1.0f + (-layer.output.array()).exp());
        input = &layer.output;
    }
    displacement.resize(input->size() / 3, 3);
    using PointsF = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    displacement =
        m_scale * Eigen::Map<const PointsF>(input->data(), displacement.rows(), 3).cast<double>();
}

}  // namespace cloth
