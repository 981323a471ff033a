#pragma once

#include <map>
#include <string>

#include "data/body/animated_body.h"
#include "data/core/garment.h"
#include "gnn/skinning/skinning_config.h"

namespace cloth {

/// A trained skinning network, with the garment that it is of, as a file, see TensorFile.
///
///     const SkinningWeights weights = SkinningWeights::load(file);
struct SkinningWeights {
    SkinningConfig config;
    std::map<std::string, WeightTensor> tensors;  ///< tensor_shapes()

    /// @throws LoadError naming file, tensor and reason: no such file, another format, a tensor
    ///         that is missing, unknown, misshaped or holds a number that is not finite, deviations
    ///         that are not positive, or skin weights that do not sum to 1
    static SkinningWeights load(const std::string& file);

    /// Writes a temporary file and renames it.
    /// @throws ArgumentError if a tensor is none that load() takes, LoadError if it cannot be
    /// written
    void save(const std::string& file) const;

    /// @throws ArgumentError if there is no such tensor
    const WeightTensor& tensor(const std::string& name) const;

    Points points(const std::string& name) const;  ///< of "rest" or "worn" (|V| x 3, m)
    /// Of the garment's vertices.
    /// @param joint_index  of each of config.joints
    SkinWeights skin(const std::vector<int>& joint_index) const;
};

/// What a network for a garment on a body is before it is trained: all but its layers and the
/// statistics of its input, which are zero and one. It sees the joints that the garment follows,
/// and those that lie between them and the root.
/// @param worn  |V| x 3 (m): in the body's rest pose
/// @throws ArgumentError as GarmentSkinning and SkinningConfig::check() do
SkinningWeights untrained_skinning(const Garment& garment, const Points& worn,
                                   const AnimatedBody& body, SkinningConfig config = {});

}  // namespace cloth
