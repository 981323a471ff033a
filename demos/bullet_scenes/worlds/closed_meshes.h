#pragma once

#include "scene_world.h"

/// A torus around the y axis as SoftDemo has it: 30 x 10 nodes, its tube of 0.5 m 2 m from the
/// axis.
btSoftBody* createTorus(btSoftBodyWorldInfo& info);

/// A convex ball of n nodes.
btSoftBody* createBall(btSoftBodyWorldInfo& info, const btVector3& centre, btScalar radius, int n);

/// A closed mesh of the size and the numbers of SoftDemo's bunny: 453 nodes and 902 faces in a box
/// of 0.9 x 1.4 x 2 m, with two ears.
btSoftBody* createHare(btSoftBodyWorldInfo& info);
