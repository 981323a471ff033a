#pragma once

#include <vector>

#include "bullet_ext/clothStep.h"

namespace cloth {

/// What each node touches at the end of a cloth step.
struct ClothTouches {
    std::vector<int> solid;  ///< |V|: number in ClothStep::near, or -1
    Points place;            ///< |V| x 3 (m): where the node, or its edge or face, touches it
};

/// What pushed cloth out of a solid, or out of its way, moved it; it must not throw it. So no
/// contact leaves a node with a velocity away from the surface that it has not without the contact.
/// Between two solids a node moves with the one that it keeps to, and slides over it no faster than
/// the other one does.
/// @param free  velocities, had nothing from outside held the cloth (|V| x 3, m/s)
void calmContacts(const ClothStep& step, const ClothTouches& touches, const Points& free);

/// No node gets faster than what could have made it so: other cloth, solids that are touched and
/// pins, or gravity, node forces and the fabric's own, as `free` has them.
void capSpeeds(const ClothStep& step, const ClothTouches& touches, const Points& free);

}  // namespace cloth
