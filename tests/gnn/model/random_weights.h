#pragma once

#include <cmath>
#include <random>

#include "gnn/model/weights.h"

namespace cloth::test {

/// Seeded numbers in place of a training.
inline Weights random_weights(const ModelConfig& config) {
    Weights weights;
    weights.config = config;
    std::mt19937 random(1);
    for (const auto& [name, shape] : parameter_shapes(config)) {
        size_t count = 1;
        for (const int extent : shape) count *= static_cast<size_t>(extent);
        std::normal_distribution<float> normal(0.0f,
                                               std::sqrt(2.0f / static_cast<float>(shape.back())));
        WeightTensor tensor{shape, std::vector<float>(count)};
        for (float& value : tensor.data) value = normal(random);
        weights.tensors[name] = std::move(tensor);
    }
    for (const auto& [name, shape] : statistics_shapes(config))
        weights.tensors[name] = {shape, std::vector<float>(static_cast<size_t>(shape[0]), 1.0f)};
    return weights;
}

}  // namespace cloth::test
