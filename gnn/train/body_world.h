#pragma once

#include <functional>

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

/// Calls `use` with each garment vertex, each vertex of the skin around its nearest one, and that
/// one's weight; the weights of a garment vertex sum to 1. Smooth over 3 cm of skin.
/// @param garment, skin  |V| x 3 (m)
void for_each_skin_neighbour(const Points& garment, const Points& skin,
                             const std::function<void(Eigen::Index, Eigen::Index, double)>& use);

/// How far garment vertices (|V| x 3, m) on a skin are carried along when it changes shape: each by
/// the mean displacement of the skin around its nearest point (|V| x 3, m). A garment keeps its
/// ease where both its worn and its rest shape move by that.
Points carried_along(const Points& garment, const Points& skin_before, const Points& skin_after);

}  // namespace cloth
