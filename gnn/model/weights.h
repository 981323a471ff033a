#pragma once

#include <map>
#include <optional>
#include <string>

#include "gnn/model/model_config.h"
#include "gnn/model/tensor_file.h"

namespace cloth {

/// A trained network as a file, see TensorFile. The configuration and the format version stand in
/// its metadata.
///
///     Weights weights = Weights::load("data/assets/weights/fast.safetensors");
///     const WeightTensor& bias = weights.tensor("decoder.output.bias");
struct Weights {
    ModelConfig config;
    std::map<std::string, WeightTensor> tensors;  ///< parameter_shapes() and statistics_shapes()
    std::optional<std::string> called;  ///< load() takes the name of the file, without folder and
                                        ///< ending; none: made in memory

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

    /// What solvers that use it are called: as the file, else as the variant.
    std::string solver_name() const { return called.value_or(config.variant); }
};

}  // namespace cloth
