#pragma once

#include "data/body/animated_body.h"
#include "gnn/train/scene_random.h"
#include "gnn/train/training_scene.h"

namespace cloth {

/// A garment on a moving body, the whole scene turned about the vertical.
/// @param yaw    (rad)
/// @param start  in the body's frame, before the turn
SceneParts make_body_parts(std::shared_ptr<const Garment> garment,
                           std::shared_ptr<const AnimatedBody> body, double yaw, ClothState start);

/// The part of a motion from a frame on; at least `least` frames, from an earlier frame if need be.
Motion motion_from(const Motion& motion, int frame, int least);

/// How far garment vertices (|V| x 3, m) on a skin are carried along when it changes shape: each by
/// the mean displacement of the skin around its nearest point (|V| x 3, m). A garment keeps its
/// ease where both its worn and its rest shape move by that.
Points carried_along(const Points& garment, const Points& skin_before, const Points& skin_after);

}  // namespace cloth
