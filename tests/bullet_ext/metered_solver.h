#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bullet_ext/softBodyGarment.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::test {

/// Measures the energy of cloth and rigid bodies around each world step of the cloth. What Bullet
/// does to its bodies before that, such as lifting them out of each other, does not count. But what
/// bodies that hang or lie on the cloth have lost in Bullet's step, as bodies do that fall, may
/// come back.
class MeteredSolver : public btGnnSoftBodySolver {
 public:
    using btGnnSoftBodySolver::btGnnSoftBodySolver;

    std::vector<btRigidBody*> bodies;  ///< that count
    btSoftBody* cloth = nullptr;       ///< that counts
    bool bears_all = false;            ///< the cloth alone bears the bodies

    /// Energy of motion and height that the steps of the cloth have made out of nothing at most, up
    /// to any moment, less what they have taken away till then (J).
    double made() const { return m_made; }
    /// The same at present, and with the energy of the fabric. In the step in which a body hits it,
    /// the fabric may take up more than the body loses; it keeps that from becoming motion.
    double balance() const { return m_balance; }
    /// Most energy that there was in motion (J): what the others are compared with.
    double scale() const { return m_scale; }

    void predictMotion(btScalar h) override {
        m_hanging = ofHanging();
        btGnnSoftBodySolver::predictMotion(h);
    }

    void solveConstraints(btScalar h) override {
        const double lost = std::max(0.0, m_hanging - ofHanging());
        const double motion = energy() + lost, before = motion + elastic();
        btGnnSoftBodySolver::solveConstraints(h);
        const double now = energy();
        m_gained += now - motion;
        m_made = std::max(m_made, m_gained);
        m_balance += now + elastic() - before;
        m_scale = std::max(m_scale, m_moving);
    }

    /// Of motion and height (J).
    double energy() {
        double sum = 0.0;
        m_moving = 0.0;
        for (const btRigidBody* body : bodies) {
            m_moving += kinetic(*body);
            sum += height(*body);
        }
        const Garment* garment = garmentOf(cloth);
        const double ratio = garment ? massRatio(*cloth, *garment) : 0.0;
        for (int i = 0; garment && i < cloth->m_nodes.size(); ++i) {
            const btSoftBody::Node& node = cloth->m_nodes[i];
            if (!(node.m_im > 0)) continue;
            const double mass = ratio * garment->masses()[i];
            m_moving += 0.5 * mass * toVec3(node.m_v).squaredNorm();
            sum -= mass * toVec3(cloth->m_worldInfo->m_gravity).dot(toVec3(node.m_x));
        }
        return sum + m_moving;
    }

    /// Motion and height of bodies that the cloth alone bears (J).
    double ofHanging() const {
        double sum = 0.0;
        for (const btRigidBody* body : bodies)
            if (bears_all || isAnchored(*body)) sum += kinetic(*body) + height(*body);
        return sum;
    }

    bool isAnchored(const btRigidBody& body) const {
        for (int a = 0; cloth && a < cloth->m_anchors.size(); ++a)
            if (cloth->m_anchors[a].m_body == &body) return true;
        return false;
    }

    /// Of the fabric (J).
    double elastic() const {
        const Garment* garment = garmentOf(cloth);
        return garment ? massRatio(*cloth, *garment) *
                             stepperOf(cloth)->internal_energy(nodePositions(*cloth)).value_or(0.0)
                       : 0.0;
    }

    static double height(const btRigidBody& body) {
        if (!(body.getInvMass() > 0)) return 0.0;
        return -toVec3(body.getGravity()).dot(toVec3(body.getCenterOfMassPosition())) /
               body.getInvMass();
    }

    static double kinetic(const btRigidBody& body) {
        if (!(body.getInvMass() > 0)) return 0.0;
        const Vec3 turn = toMatrix(body.getWorldTransform().getBasis()).transpose() *
                          toVec3(body.getAngularVelocity());
        const Vec3 inverse = toVec3(body.getInvInertiaDiagLocal());
        double sum = 0.5 * toVec3(body.getLinearVelocity()).squaredNorm() / body.getInvMass();
        for (int c = 0; c < 3; ++c)
            if (inverse[c] > 0.0) sum += 0.5 * turn[c] * turn[c] / inverse[c];
        return sum;
    }

 private:
    double m_hanging = 0.0;  ///< of bodies on the cloth, at the start of the world step (J)
    double m_balance = 0.0, m_gained = 0.0, m_made = 0.0, m_scale = 0.0, m_moving = 0.0;
};

}  // namespace cloth::test
