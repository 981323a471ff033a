#pragma once

#include <string>
#include <vector>

#include "gnn/model/tensor_file.h"

namespace cloth {

/// What a garment-specific skinning network is: it has learned how one garment lies on one body.
/// From the poses of a few joints it answers with a displacement for each vertex of the garment as
/// it is worn in the body's rest pose; linear blend skinning then poses the displaced garment.
///
/// It is of the class of PBNS (Bertiche et al., ACM Trans. Graph. 40(6), 2021), SNUG (Santesteban
/// et al., CVPR 2022), SSCH (Santesteban et al., CVPR 2021) and Diao et al. (Comput. Graph. Forum
/// 42(7), 2023). As in PBNS and SNUG there is no ground truth. As in SNUG the answer depends on the
/// poses before, here on those of given ages instead of a recurrent state: so an answer does not
/// depend on how the network came to it.
struct SkinningConfig {
    static constexpr int format_version = 1;

    std::string garment;              ///< that it was trained for, for messages
    int vertices = 0;                 ///< |V| of it, 3 to 100,000
    std::vector<std::string> joints;  ///< that it sees, 1 to 100; parents first, the root is first
    std::vector<int> ages = {0, 1, 2, 4, 8};    ///< of the poses that it sees, in steps before
                                                ///< the end of the step; ascending from 0, to
                                                ///< 100
    std::vector<int> layers = {256, 192, 128};  ///< widths of the hidden layers, 1 to 10 of 1 to
                                                ///< 2048
    double scale = 0.01;                        ///< of an output of 1 (m), 1e-4 to 1
    double dt = 1.0 / 30.0;                     ///< time step that it is trained for (s), 1e-4 to 1

    int feature_count() const;  ///< see PoseFeatures

    /// @throws ArgumentError naming the field that is out of range
    void check() const;

    std::string to_json() const;
    /// @param file  named in errors
    /// @throws LoadError for a field that is missing, of the wrong type or out of range
    static SkinningConfig from_json(const std::string& text, const std::string& file);
};

/// layer.K.{weight,bias} of the multilayer perceptron, weights as (outputs x inputs), the last of
/// 3 |V| outputs; input.{mean,deviation} of the features; and what the garment is: rest (|V| x 3,
/// m), worn (|V| x 3, m: in the rest pose of the body) and skin (|V| x |joints|: how much each
/// vertex follows each joint).
std::vector<TensorShape> tensor_shapes(const SkinningConfig& config);

}  // namespace cloth
