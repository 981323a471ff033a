#pragma once

#include <vector>

#include "bullet_ext/bulletObstacles.h"
#include "data/core/follower.h"

class btSoftBody;

namespace cloth {

/// Lets a follower of a body's nodes show the end of the present world step.
/// @param x        where the nodes are (|nodes| x 3, m)
/// @param ignored  limbs that they ignore, or empty
/// @param h        length of the world step (s)
void showFollower(const btSoftBody& body, const Points& x, const std::vector<LimbSet>& ignored,
                  BulletObstacles& obstacles, double h, Follower& follower);

}  // namespace cloth
