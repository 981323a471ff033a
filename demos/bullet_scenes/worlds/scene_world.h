#pragma once

// This folder is written against Bullet's public API alone, as a Bullet user would: it knows
// nothing of FastCloth, and its build has no other include path than Bullet's.

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <functional>
#include <memory>
#include <vector>

/// A Bullet world and all that is in it.
class SceneWorld {
 public:
    /// @param solver  the one line that differs: null is Bullet's own soft body solver
    explicit SceneWorld(btSoftBodySolver* solver);
    ~SceneWorld();
    SceneWorld(const SceneWorld&) = delete;
    SceneWorld& operator=(const SceneWorld&) = delete;

    /// Moves what the scene moves and makes one step of h seconds.
    void step(btScalar h);
    double time() const { return m_time; }

    btSoftRigidDynamicsWorld& world() { return m_world; }
    btSoftBodyWorldInfo& info() { return m_world.getWorldInfo(); }

    /// Gravity and cells of Bullet's distance fields as Bullet's own demos have them.
    void setUpLikeBulletsDemos();

    /// A body of the shape, which the world keeps; bodies may share one. Mass 0 (kg): static, or
    /// kinematic.
    btRigidBody* addRigid(btCollisionShape* shape, const btVector3& position, btScalar mass = 0,
                          bool kinematic = false);
    /// A static object that is no rigid body, as the ground of Bullet's demos.
    btCollisionObject* addObject(btCollisionShape* shape, const btVector3& position);
    /// A shape for several bodies, or for a part of one.
    btCollisionShape* keepShape(btCollisionShape* shape);
    /// Cloth as a careful user sets it up: fabric-like mass, small margin, ten iterations.
    btSoftBody* addCloth(btSoftBody* cloth, btScalar mass);
    /// Cloth with the settings that it has.
    btSoftBody* addClothAsItIs(btSoftBody* cloth);
    /// A soft body that is not cloth.
    btSoftBody* addSoft(btSoftBody* body);
    /// A level square of n x n nodes; `corners` are fixed as in btSoftBodyHelpers::CreatePatch().
    btSoftBody* addSheet(const btVector3& centre, btScalar side, int n, int corners = 0);
    btTriangleMesh* newTriangles();

    const std::vector<std::unique_ptr<btRigidBody>>& rigid() const { return m_rigid; }
    /// Rigid bodies and objects.
    std::vector<const btCollisionObject*> solids() const;
    const std::vector<btSoftBody*>& cloth() const { return m_cloth; }
    const std::vector<btSoftBody*>& others() const { return m_others; }

    /// Called before each step with the time at its end (s), if set.
    std::function<void(btScalar time)> drive;

    /// Leaves nothing that momentum could come from or go to: no gravity, no pins, no fixed bodies.
    void closeSystem();

 private:
    btSoftBodyRigidBodyCollisionConfiguration m_config;
    btCollisionDispatcher m_dispatcher;
    btDbvtBroadphase m_broadphase;
    btSequentialImpulseConstraintSolver m_rigidSolver;
    btSoftRigidDynamicsWorld m_world;
    std::vector<std::unique_ptr<btTriangleMesh>> m_triangles;
    std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
    std::vector<std::unique_ptr<btRigidBody>> m_rigid;
    std::vector<std::unique_ptr<btCollisionObject>> m_objects;
    std::vector<std::unique_ptr<btSoftBody>> m_soft;
    std::vector<btSoftBody*> m_cloth, m_others;
    double m_time = 0.0;
};
