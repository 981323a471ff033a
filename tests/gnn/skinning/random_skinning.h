#pragma once

#include <cmath>
#include <memory>
#include <random>

#include "data/files/garment_assets.h"
#include "gnn/skinning/skinning_weights.h"

namespace cloth::test {

/// The default body in motion 01_01.
inline std::shared_ptr<const AnimatedBody> walker() {
    static const auto animated = std::make_shared<const AnimatedBody>(
        std::make_shared<const Body>(Body::load_default()), load_motion_by_name("01_01"));
    return animated;
}

/// Seeded numbers in place of a training, for the small T-shirt on the default body; small enough
/// for the garment to stay a garment.
/// @param size  0: the answer is the skinned garment as worn
inline SkinningWeights random_skinning(const Garment& garment, double size = 1.0) {
    SkinningConfig config;
    config.layers = {24, 16};
    SkinningWeights weights =
        untrained_skinning(garment, garment.rest().vertices, *walker(), config);
    std::mt19937 random(1);
    for (auto& [name, tensor] : weights.tensors) {
        if (name.rfind("layer.", 0) != 0) continue;
        const double inputs = tensor.shape.size() == 2 ? tensor.shape[1] : 4.0;
        std::normal_distribution<float> normal(0.0f, static_cast<float>(size / std::sqrt(inputs)));
        if (size > 0.0)
            for (float& value : tensor.data) value = normal(random);
    }
    return weights;
}

}  // namespace cloth::test
