#pragma once

#include <vector>

#include "tests/bullet_ext/bullet_world.h"
#include "tests/fuzz/fuzz_random.h"

namespace cloth::test {

/// A patch, a mesh or a body made by hand near the origin; often with a defect: duplicate faces,
/// nodes without a face, faces without area, NaN, masses that are zero, infinite or negative.
btSoftBody* random_soft_body(btSoftBodyWorldInfo& info, Random& random);

/// Of any kind; some without extent, flat or huge.
btCollisionShape* random_shape(Random& random);

/// What a program may do to a world between two steps, and what it may do by mistake.
class WorldMeddler {
 public:
    WorldMeddler(test::World& world, btGnnSoftBodySolver& solver, Random& random)
        : m_world(world), m_solver(solver), m_random(random) {}

    void add_soft_body();
    void add_rigid_body();
    /// One of all kinds of changes.
    void meddle();

    const std::vector<btSoftBody*>& soft() const { return m_soft; }

 private:
    void remove_soft_body();
    void remove_rigid_body();
    void change_nodes(btSoftBody& body);
    void move_body(btSoftBody& body);
    void push(btSoftBody& body);
    void change_settings(btSoftBody& body);
    void change_topology(btSoftBody& body);
    void anchor(btSoftBody& body);
    void put_to_sleep_or_wake(btSoftBody& body);
    void ask_the_solver(btSoftBody& body);
    void set_goals(btSoftBody& body);
    void animate(btRigidBody& body);
    void move_rigid_body(btRigidBody& body);

    test::World& m_world;
    btGnnSoftBodySolver& m_solver;
    Random& m_random;
    std::vector<btSoftBody*> m_soft;
    std::vector<btRigidBody*> m_rigid;
};

}  // namespace cloth::test
