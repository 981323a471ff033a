#pragma once

#include <vector>

#include "gnn/skinning/skinning_weights.h"

namespace cloth {

/// Evaluates a skinning network without LibTorch: a multilayer perceptron of few and dense layers,
/// with x / (1 + e^-x) (SiLU) between them. Once built it allocates nothing.
class SkinningNetwork {
 public:
    /// Inputs farther from their mean than so many deviations are taken to be that far: poses that
    /// it has never seen should not give answers without bounds.
    static constexpr float most_deviations = 5.0f;

    explicit SkinningNetwork(const SkinningWeights& weights);

    /// @param features      as PoseFeatures builds them
    /// @param displacement  |V| x 3 (m): of the garment as worn, in the body's rest pose
    void evaluate(const VectorX& features, Points& displacement);

 private:
    using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    struct Layer {
        Matrix weight;
        Eigen::VectorXf bias, output;
    };
    VectorX m_mean, m_deviation;
    Eigen::VectorXf m_input;
    std::vector<Layer> m_layers;
    double m_scale;
};

}  // namespace cloth
