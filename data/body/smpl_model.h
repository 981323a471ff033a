#pragma once

#include <memory>
#include <string>
#include <vector>

#include "data/body/skin_weights.h"
#include "data/core/mesh.h"

namespace cloth {

/// A parametric body as a model file of SMPL, SMPL+H or SMPL-X has it (Loper et al., *SMPL: A
/// Skinned Multi-Person Linear Model*, ACM Trans. Graph. 34(6), 2015; Pavlakos et al., CVPR 2019).
/// The models themselves are not free to hand on: they are to be had from their authors.
///
///     const SmplModel model = SmplModel::load("SMPLX_NEUTRAL.npz");
///     const Points skin = model.rest(betas);
///
/// y is up; lengths are metres.
struct SmplModel {
    Points mean;                                 ///< |V| x 3 (m): v_template
    std::shared_ptr<const Faces> faces;          ///< |F| x 3
    Eigen::MatrixXf shapes;                      ///< 3|V| x |betas|: shapedirs
    Eigen::MatrixXf pose_shapes;                 ///< 3|V| x 9 (|joints| - 1): posedirs, or empty
    Eigen::MatrixXd regressor;                   ///< |joints| x |V|: from the skin to the joints
    std::vector<int> parents;                    ///< |joints|: -1 for the first; parents come first
    std::shared_ptr<const SkinWeights> weights;  ///< of the vertices

    /// Reads an .npz with v_template (V x 3), f (F x 3), weights (V x J), kintree_table (2 x J),
    /// J_regressor (J x V) or, sparse as scipy's csr_matrix has it, J_regressor_data,
    /// J_regressor_indices and J_regressor_indptr; and, if they are there, shapedirs (V x 3 x B)
    /// and posedirs (V x 3 x P).
    /// @throws LoadError naming file, array and problem
    static SmplModel load(const std::string& path);

    int joint_count() const { return static_cast<int>(parents.size()); }
    int beta_count() const { return static_cast<int>(shapes.cols()); }

    /// The skin in the pose of zero rotations (|V| x 3, m).
    /// @param betas  of the first shapes; those that are left out are zero
    /// @throws ArgumentError if there are more than the model has, or one is not finite
    Points rest(const VectorX& betas) const;
    /// Of a skin in that pose (|joints| x 3, m).
    Points joints(const Points& rest) const { return regressor * rest; }
    /// How a pose bends the skin besides skinning (|V| x 3, m), in the pose of zero rotations; zero
    /// if the model has no pose_shapes.
    /// @param rotations  |joints|, each relative to its parent
    Points pose_offsets(const std::vector<Eigen::Matrix3d>& rotations) const;
};

}  // namespace cloth
