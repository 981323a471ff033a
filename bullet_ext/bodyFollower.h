#pragma once

#include <vector>

#include "bullet_ext/bulletObstacles.h"

class btSoftBody;

namespace cloth {

/// The obstacles around what is shown of a body, as they are at the end of the present world step.
/// @param x  finite (m): where the nodes are, and whatever else is to be shown
/// @param h  length of the world step (s)
Boundary obstaclesAround(const btSoftBody& body, const std::vector<const Points*>& x,
                         BulletObstacles& obstacles, double h);

}  // namespace cloth
