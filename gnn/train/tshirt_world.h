#pragma once

#include "data/body/animated_body.h"
#include "gnn/train/scene_random.h"
#include "gnn/train/training_scene.h"

namespace cloth {

/// A garment on a moving body, the whole scene turned about the vertical.
/// @param rest  the garment, made for the body's rest pose
/// @param yaw   (rad)
SceneParts make_body_parts(std::shared_ptr<const Garment> garment,
                           std::shared_ptr<const AnimatedBody> body, double yaw);

/// The part of a motion from a frame on; at least `least` frames, from an earlier frame if need be.
Motion motion_from(const Motion& motion, int frame, int least);

/// Garment vertices (|V| x 3, m) carried along when the skin under them changes shape: each moves
/// by the mean displacement of the skin around its nearest point.
Points carry_garment(const Points& garment, const Points& skin_before, const Points& skin_after);

}  // namespace cloth
