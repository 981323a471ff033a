#pragma once

#include <memory>
#include <vector>

#include "data/body/retarget.h"
#include "data/body/skinning.h"
#include "data/core/moving_surface.h"

namespace cloth {

struct AnimationSettings {
    double lead_in = 1.0;  ///< the body moves from its rest pose into the motion's first pose, so
                           ///< that a garment made for the rest pose settles (s), 0 to 60
    double start_ramp = 8.0 / 30.0;  ///< the motion then takes up speed over this time instead of
                                     ///< with a jolt (s), 0 to 10; it ends start_ramp / 2 later
    double friction = 0.5;           ///< of the skin against cloth (Coulomb), 0 to 1.5
    bool limbs = true;  ///< obstacles have the body's limbs: cloth passes through those that pass
                        ///< through others
    RetargetSettings retarget;
};

/// A body that moves: first from the rest pose into the motion (lead-in), then through it. Poses
/// between keys are interpolated with continuous velocity, so any time step may be used.
///
///     AnimatedBody walker(std::make_shared<Body>(Body::load_default()), motion);
///     boundary.obstacles = {walker.obstacle(t, t + dt)};
///
/// Times (s) below 0 give the rest pose, times after duration() the last pose.
class AnimatedBody : public MovingSurface {
 public:
    /// @throws LoadError if the motion's skeleton cannot be mapped to the body's
    AnimatedBody(std::shared_ptr<const Body> body, const Motion& motion,
                 const AnimationSettings& settings = {});

    const Body& body() const { return *m_body; }
    const AnimationSettings& settings() const { return m_settings; }

    std::shared_ptr<const Faces> faces() const override { return m_body->faces(); }
    std::shared_ptr<const std::vector<std::uint8_t>> limbs() const override {
        return m_settings.limbs ? m_body->limbs() : nullptr;
    }
    /// Skin vertices (|V| x 3, m).
    Points vertices(double time) const override;
    /// Lead-in and motion together (s).
    double duration() const override;

    BodyPose pose(double time) const;
    /// Where each joint moves the skin (|joints|); identities at time 0.
    JointTransforms joint_transforms(double time) const;
    /// The same as matrices.
    std::vector<SkinMatrix> skin_matrices(double time) const;

 private:
    BodyPose motion_pose(double motion_time) const;

    std::shared_ptr<const Body> m_body;
    AnimationSettings m_settings;
    double m_frame_time;
    std::vector<BodyPose> m_keys;
    std::vector<std::vector<Eigen::Quaterniond>> m_tangents;  ///< |keys| x |joints|, for squad
};

}  // namespace cloth
