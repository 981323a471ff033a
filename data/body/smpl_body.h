#pragma once

#include <memory>
#include <vector>

#include "data/body/amass_motion.h"
#include "data/body/skinning.h"
#include "data/body/smpl_model.h"
#include "data/core/moving_surface.h"

namespace cloth {

struct SmplBodySettings {
    bool pose_shapes = true;  ///< bend the skin as the model has learned it, besides skinning
    double lead_in = 1.0;     ///< the body moves from the pose of zero rotations into the motion's
                              ///< first one, so that a garment made for it settles (s), 0 to 60
    double friction = 0.5;    ///< of the skin against cloth (Coulomb), 0 to 1.5
};

/// A body of an SMPL, SMPL+H or SMPL-X model in a motion of AMASS: an obstacle as any other
/// character.
///
///     const auto model = std::make_shared<const SmplModel>(SmplModel::load("SMPLX_NEUTRAL.npz"));
///     const SmplBody body(model, AmassMotion::load("walk_poses.npz"));
///     boundary.obstacles = {body.obstacle(t, t + dt)};
///
/// It has the motion's shape. Garments are modelled on rest_vertices().
class SmplBody : public MovingSurface {
 public:
    /// Model and motion may be of two kinds: the 22 joints of the body are the same in all of them,
    /// and fingers are where both have them. Betas that the model has not are left out.
    /// @throws ArgumentError if a setting is out of range, the model is null, or neither it nor the
    ///         motion has 22 joints and their numbers differ
    SmplBody(std::shared_ptr<const SmplModel> model, const AmassMotion& motion,
             const SmplBodySettings& settings = {});

    std::shared_ptr<const Faces> faces() const override { return m_model->faces; }
    Points vertices(double time) const override;
    /// Lead-in and motion (s).
    double duration() const override;

    /// Where the lead-in begins (|V| x 3, m): in the pose of zero rotations, the soles on y = 0,
    /// above or below the motion's first place.
    Points rest_vertices() const;
    TriMesh rest_mesh() const { return {rest_vertices(), *m_model->faces}; }
    const SkinWeights& weights() const { return *m_model->weights; }
    /// Where each joint moves the skin of rest_vertices() at `time` (s): what is worn on it, and
    /// has the skin's weights, comes along.
    std::vector<SkinMatrix> skin_matrices(double time) const;

 private:
    struct Pose {
        std::vector<Eigen::Quaterniond> rotations;  ///< of the model's joints
        Vec3 translation;                           ///< (m)
    };
    Pose pose(double time) const;
    std::vector<SkinMatrix> matrices(const Pose& pose) const;

    std::shared_ptr<const SmplModel> m_model;
    SmplBodySettings m_settings;
    double m_frame_time;
    std::vector<Pose> m_frames;
    Pose m_start;
    Points m_rest, m_joints;  ///< as the model has them: before the translation (m)
};

}  // namespace cloth
