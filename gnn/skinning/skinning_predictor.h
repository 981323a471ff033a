#pragma once

#include <deque>
#include <memory>

#include "data/body/joint_fit.h"
#include "data/core/boundary.h"
#include "gnn/skinning/pose_features.h"
#include "gnn/skinning/skinning_network.h"

namespace cloth {

/// Says where a garment is at the end of a step by the poses of the body alone: those at its start
/// and end, and those that it has seen before.
///
/// The poses come from the skin that the boundary has as an obstacle (see JointFit). So whoever
/// steps a garment among obstacles can use it as any other solver, and no other clock, skeleton or
/// animation system has to be told apart from the skin.
class SkinningPredictor {
 public:
    /// The skin may be this far (m, RMS) from the nearest one that the body's joints can make.
    static constexpr double most_misfit = 2e-3;

    /// @throws ArgumentError if the body lacks a joint, or the weights are of another garment: of
    ///         other vertices, or a rest shape that differs by more than 1 mm
    SkinningPredictor(const Garment& garment, std::shared_ptr<const SkinningWeights> weights,
                      std::shared_ptr<const Body> body);

    const SkinningConfig& config() const { return m_weights->config; }

    /// @param x  |V| x 3 (m): at the end of the step
    /// @return   false, `x` untouched: no obstacle is the skin of this body
    bool predict(const Boundary& boundary, Points& x);

 private:
    const Obstacle* find_body(const Boundary& boundary);
    void remember(const Points& skin0);

    std::shared_ptr<const SkinningWeights> m_weights;
    std::shared_ptr<const Body> m_body;
    JointFit m_fit;
    PoseFeatures m_features;
    SkinningNetwork m_network;
    SkinWeights m_skin;
    Points m_worn, m_displacement;
    VectorX m_input;
    std::vector<SkinMatrix> m_matrices0, m_matrices1;
    Points m_last_skin;           ///< at the end of the last step
    std::deque<SeenPose> m_seen;  ///< the pose at the start of the step first, then older ones
};

}  // namespace cloth
