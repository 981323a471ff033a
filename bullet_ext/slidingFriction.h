#pragma once

#include <vector>

#include "bullet_ext/bulletObstacles.h"
#include "data/core/cloth_state.h"
#include "data/core/garment.h"
#include "gnn/stepper.h"

class btSoftBody;

namespace cloth {

/// A step of the cloth, as friction needs it.
struct SlidingStep {
    const Garment& garment;
    const Stepper& stepper;
    const std::vector<SlidingSolid>& solids;  ///< near the cloth, at the end of the step
    double length;                            ///< (s)
    double world_step;                        ///< (s)
    const ClothState& from;
    ClothState& to;  ///< velocities are changed, and places of nodes that stick
};

/// Friction of Bullet's soft bodies, where it is more than Coulomb's. With the coefficient c = kDF
/// times the object's friction, a node that touches an object loses in each world step
///
/// - the share c of its motion along the surface, however hard it presses: a brake, with which a
///   sheet that is pushed at v stops after v h (1 - c) / c;
/// - that share in each of piterations, if the cloth pulls the node into the surface: Bullet's
/// links
///   press it against its contact anew in each of them. Others press once only, by their weight;
/// - all but the part 1 / piterations, if its own motion and gravity are within the cone of c.
///
/// Steppers give Coulomb's friction of coefficient c, which is more for slow slips; a node loses
/// the larger of the two. A node touches what it is nearer to than 5 mm and a tenth of an edge:
/// what lies on a round solid is held by the middles of its edges.
///
/// Dynamic bodies get the opposite impulses, which are smaller the lighter the body is, so that
/// nothing is thrown back: momentum is kept, and energy is only lost. Nodes that stick stay where
/// they were, as far as that does not stretch the fabric by more energy than friction took.
/// Animated meshes, which Bullet does not have, have Coulomb's friction alone.
void applySlidingFriction(btSoftBody& body, const SlidingStep& step);

}  // namespace cloth
