#pragma once

#include "bullet_ext/bulletTypes.h"
#include "data/core/cloth_state.h"

class btSoftBody;

namespace cloth {

/// Anchors of influence below one are pulls, not pins: Bullet's anchor impulse
///
///     p = K^-1 ((v_body - v_node) + kAHR (x_body - x_node) / h) influence
///
/// on the node and -p on the body, with K the inverse mass of the two at the anchor. Bullet applies
/// it in each of m_cfg.piterations iterations of each world step; here it is applied once per step
/// of the stepper, with the influence that so many repetitions have, 1 - (1 - influence)^n. The
/// node has the mass that it moves with, see massRatio(): the impulses cancel.
///
/// @param state          the cloth at the start of the cloth step
/// @param length         of the cloth step (s)
/// @param world_step     (s)
/// @param accelerations  |V| x 3 (m/s^2), or empty: of the nodes during the cloth step, added to
void pullSoftAnchors(btSoftBody& body, const Garment& garment, const ClothState& state,
                     double length, double world_step, Points& accelerations);

}  // namespace cloth
