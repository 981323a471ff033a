#pragma once

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "bullet_ext/btGnnSoftBodySolver.h"

namespace cloth::test {

/// A Bullet world with the given soft body solver (null: Bullet's own), gravity -9.81 along y for
/// rigid and soft bodies alike. Owns what is added to it.
class World {
 public:
    explicit World(btSoftBodySolver* solver = nullptr)
        : m_dispatcher(&m_config),
          m_world(std::make_unique<btSoftRigidDynamicsWorld>(&m_dispatcher, &m_broadphase,
                                                             &m_rigid_solver, &m_config, solver)) {
        m_world->setGravity({0, -9.81f, 0});
        m_world->getWorldInfo().m_gravity = {0, -9.81f, 0};
        m_world->getWorldInfo().m_dispatcher = &m_dispatcher;
        m_world->getWorldInfo().m_broadphase = &m_broadphase;
        m_world->getWorldInfo().m_sparsesdf.Initialize();
    }
    ~World() {
        for (auto& body : m_soft) m_world->removeSoftBody(body.get());
        for (auto& object : m_objects) m_world->removeCollisionObject(object.get());
        m_world.reset();
    }

    btSoftRigidDynamicsWorld& operator*() { return *m_world; }
    btSoftRigidDynamicsWorld* operator->() { return m_world.get(); }
    btSoftBodyWorldInfo& info() { return m_world->getWorldInfo(); }

    btSoftBody* add(btSoftBody* body) {
        m_soft.emplace_back(body);
        m_world->addSoftBody(body);
        return body;
    }
    void remove(btSoftBody* body) {
        m_world->removeSoftBody(body);
        for (auto it = m_soft.begin(); it != m_soft.end(); ++it)
            if (it->get() == body) {
                m_soft.erase(it);
                return;
            }
    }
    /// A static or kinematic (mass 0) or dynamic body of the shape; the world keeps both.
    btRigidBody* add(btCollisionShape* shape, const btVector3& position, bool kinematic = false,
                     btScalar mass = 0) {
        m_shapes.emplace_back(shape);
        btVector3 inertia(0, 0, 0);
        if (mass > 0) shape->calculateLocalInertia(mass, inertia);
        auto* body = new btRigidBody(mass, nullptr, shape, inertia);
        body->setWorldTransform(btTransform(btQuaternion::getIdentity(), position));
        body->setInterpolationWorldTransform(body->getWorldTransform());
        if (kinematic) {
            body->setCollisionFlags(body->getCollisionFlags() |
                                    btCollisionObject::CF_KINEMATIC_OBJECT);
            body->setActivationState(DISABLE_DEACTIVATION);
        }
        m_objects.emplace_back(body);
        m_world->addRigidBody(body);
        return body;
    }
    void remove(btRigidBody* body) {
        m_world->removeRigidBody(body);
        for (auto it = m_objects.begin(); it != m_objects.end(); ++it)
            if (it->get() == body) {
                m_objects.erase(it);
                return;
            }
    }
    void step(double h, int count = 1) {
        for (int i = 0; i < count; ++i) m_world->stepSimulation(static_cast<btScalar>(h), 0);
    }

 private:
    btSoftBodyRigidBodyCollisionConfiguration m_config;
    btCollisionDispatcher m_dispatcher;
    btDbvtBroadphase m_broadphase;
    btSequentialImpulseConstraintSolver m_rigid_solver;
    std::unique_ptr<btSoftRigidDynamicsWorld> m_world;
    std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
    std::vector<std::unique_ptr<btCollisionObject>> m_objects;
    std::vector<std::unique_ptr<btSoftBody>> m_soft;
};

/// A level patch of n x n nodes and 1 m edges around `centre`; `pins` as in Bullet: 1, 2, 4 and 8
/// fix the corners 00, 10, 01 and 11.
inline btSoftBody* patch(btSoftBodyWorldInfo& info, const btVector3& centre, int n = 5,
                         int pins = 0) {
    const btScalar r = 0.5f;
    return btSoftBodyHelpers::CreatePatch(
        info, centre + btVector3(-r, 0, -r), centre + btVector3(r, 0, -r),
        centre + btVector3(-r, 0, r), centre + btVector3(r, 0, r), n, n, pins, true);
}

/// Falls by the semi-implicit rule, has no stiffness, and remembers what it was told.
class FreeFall : public Stepper {
 public:
    struct Log {
        std::vector<Boundary> boundaries;
        std::vector<double> dts;
        int fail_after = -1;  ///< steps until it fails; -1: never
    };
    FreeFall(const Garment& garment, std::shared_ptr<Log> log = nullptr, double fixed = 0.0)
        : m_garment(garment), m_log(std::move(log)), m_fixed(fixed) {}

    std::string name() const override { return "free fall"; }
    double fixed_dt() const override { return m_fixed; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override {
        StepReport report;
        if (m_log) {
            m_log->boundaries.push_back(boundary);
            m_log->dts.push_back(dt);
            if (m_log->fail_after >= 0 &&
                m_log->dts.size() > static_cast<size_t>(m_log->fail_after)) {
                report.finite = false;
                return report;
            }
        }
        const Points before = state.x;
        state.v.rowwise() += dt * boundary.gravity.transpose();
        if (boundary.accelerations.size()) state.v += dt * boundary.accelerations;
        state.x += dt * state.v;
        const std::vector<int>& pins = m_garment.pins();
        for (size_t p = 0; p < pins.size(); ++p) {
            state.x.row(pins[p]) = boundary.pin_targets.row(static_cast<Eigen::Index>(p));
            state.v.row(pins[p]) = (state.x.row(pins[p]) - before.row(pins[p])) / dt;
        }
        state.time += dt;
        return report;
    }

 private:
    const Garment& m_garment;
    std::shared_ptr<Log> m_log;
    double m_fixed;
};

inline StepperFactory free_fall(std::shared_ptr<FreeFall::Log> log = nullptr, double fixed = 0.0) {
    return [=](const Garment& garment) { return std::make_unique<FreeFall>(garment, log, fixed); };
}

/// (m/s)
inline double fastest_node(const btSoftBody& body) {
    double speed = 0.0;
    for (int i = 0; i < body.m_nodes.size(); ++i)
        speed = std::max(speed, static_cast<double>(body.m_nodes[i].m_v.length()));
    return speed;
}

inline Vec3 node(const btSoftBody& body, int i) {
    const btVector3& x = body.m_nodes[i].m_x;
    return {x.x(), x.y(), x.z()};
}

}  // namespace cloth::test
