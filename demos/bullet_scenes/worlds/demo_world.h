#pragma once

#include "scene_world.h"

// What the scenes of Bullet's demos share. Sizes, masses and settings are those of Bullet's
// examples/SoftDemo and examples/SoftBody; everything else is written anew.

/// The world of SoftDemo: gravity 10 m/s^2 and a box whose top is at y = -10.5 m.
void layGround(SceneWorld& scene);

/// A level square of n x n nodes and 2 `half` m a side, with Bullet's settings, in no world yet.
btSoftBody* demoSheet(SceneWorld& scene, const btVector3& centre, btScalar half, int n,
                      int corners);

/// Bending links across two edges, of a material of their own.
void addBending(btSoftBody* body, btScalar stiffness = 1);

/// As btSoftBody::randomizeConstraints(), which goes on where the last body of the program ended:
/// this one makes equal bodies of equal ones.
void shuffleLinks(btSoftBody* body);

/// Random numbers that are the same everywhere.
class DemoRandom {
 public:
    explicit DemoRandom(unsigned start) : m_state(start) {}
    btScalar between(btScalar low, btScalar high);
    btVector3 direction();
    int below(int count);

 private:
    unsigned m_state;
};
