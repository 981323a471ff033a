#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gnn/model/weights.h"

namespace cloth {

/// The learned numbers of a network in one flat tensor, with named views into it, and their
/// gradients likewise: optimiser, clipping and checkpoints are then a handful of large operations
/// instead of some per layer.
class Parameters {
 public:
    /// Uniform in +-1/sqrt(inputs) like LibTorch's linear layers; the decoder's last layer is ten
    /// times smaller, so that an untrained network stays near its base guess.
    Parameters(const ModelConfig& config, torch::Device device, std::uint64_t seed)
        : Parameters(parameter_shapes(config), "decoder.output", device, seed) {}
    /// @param output  tensors whose names begin so are ten times smaller
    Parameters(const std::vector<TensorShape>& shapes, const std::string& output,
               torch::Device device, std::uint64_t seed);

    const torch::Tensor& view(const std::string& name) const;

    torch::Tensor& flat() { return m_flat; }          ///< (count), shares memory with the views
    torch::Tensor& gradient() { return m_gradient; }  ///< (count), filled by backward()
    std::int64_t count() const { return m_flat.numel(); }

    void copy_to(std::map<std::string, WeightTensor>& tensors) const;
    /// @param tensors  holds all of these, in their shapes
    void copy_from(const std::map<std::string, WeightTensor>& tensors);

 private:
    void initialise(const std::vector<TensorShape>& shapes, const std::string& output,
                    std::uint64_t seed);

    torch::Tensor m_flat, m_gradient;
    std::map<std::string, torch::Tensor> m_views;
};

}  // namespace cloth
