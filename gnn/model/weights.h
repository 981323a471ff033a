#pragma once

#include <map>
#include <string>
#include <vector>

#include "gnn/model/model_config.h"

namespace cloth {

/// One array of numbers, row major.
struct WeightTensor {
    std::vector<int> shape;
    std::vector<float> data;
};

/// A trained network as a file: safetensors, that is 8 bytes of header length, a JSON header, then
/// the numbers (little-endian float32). The configuration and the format version stand in the
/// header's __metadata__, so that any safetensors reader can open the file.
///
///     Weights weights = Weights::load("data/assets/weights/fast.safetensors");
///     const WeightTensor& bias = weights.tensor("decoder.output.bias");
struct Weights {
    ModelConfig config;
    std::map<std::string, WeightTensor> tensors;  ///< parameter_shapes() and statistics_shapes()

    /// @throws LoadError naming file, tensor and reason: truncated, another version, a tensor that
    ///         is missing, unknown, misshaped or holds a number that is not finite, or a deviation
    ///         that is not positive
    static Weights load(const std::string& file);

    /// Writes a temporary file and renames it, so readers never see half a file.
    /// @throws ArgumentError if a tensor is missing, misshaped or not finite
    /// @throws LoadError if the file cannot be written
    void save(const std::string& file) const;

    /// @throws ArgumentError if there is no such tensor
    const WeightTensor& tensor(const std::string& name) const;
};

}  // namespace cloth
