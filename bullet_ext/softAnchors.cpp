#include "bullet_ext/softAnchors.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>

#include "bullet_ext/softBodyGarment.h"

namespace cloth {

namespace {

/// Velocity that an impulse of 1 N s at `arm` from the centre changes between node and body.
Eigen::Matrix3d inverseMass(const btRigidBody& body, double node_inverse_mass, const Vec3& arm) {
    const Eigen::Matrix3d cross = crossMatrix(arm);
    return (node_inverse_mass + static_cast<double>(body.getInvMass())) *
               Eigen::Matrix3d::Identity() -
           cross * toMatrix(body.getInvInertiaTensorWorld()) * cross;
}

}  // namespace

void pullSoftAnchors(btSoftBody& body, const Garment& garment, const ClothState& state,
                     double length, double world_step, Points& accelerations) {
    const double mass_ratio = body.m_anchors.size() > 0 ? massRatio(body, garment) : 0.0;
    const Vec3 gravity = toVec3(body.m_worldInfo->m_gravity);
    for (int a = 0; a < body.m_anchors.size(); ++a) {
        const btSoftBody::Anchor& anchor = body.m_anchors[a];
        if (isHardAnchor(anchor) || !(anchor.m_node->m_im > 0)) continue;
        btRigidBody& rigid = *anchor.m_body;
        const int i = static_cast<int>(anchor.m_node - &body.m_nodes[0]);
        const double inverse_mass = 1.0 / (mass_ratio * garment.masses()[i]);
        const Vec3 place = toVec3(rigid.getWorldTransform() * anchor.m_local);
        const Vec3 arm = place - toVec3(rigid.getCenterOfMassPosition());
        const Vec3 node_velocity = Vec3(state.v.row(i)) + length * gravity;
        const Vec3 drift = toVec3(rigid.getVelocityInLocalPoint(toBullet(arm))) - node_velocity;
        const Vec3 gap = place - Vec3(state.x.row(i));
        const double repetitions = std::max(1, body.m_cfg.piterations) * length / world_step;
        const double influence = std::clamp(static_cast<double>(anchor.m_influence), 0.0, 1.0);
        const double share = 1.0 - std::pow(1.0 - influence, repetitions);
        const double hardness = body.m_cfg.kAHR;
        const Vec3 impulse =
            share *
            inverseMass(rigid, inverse_mass, arm).ldlt().solve(drift + (hardness / length) * gap);
        if (!fitsFloats(impulse)) continue;
        if (accelerations.size() == 0) accelerations = Points::Zero(state.x.rows(), 3);
        accelerations.row(i) += (inverse_mass / length) * impulse.transpose();
        rigid.activate();
        rigid.applyImpulse(toBullet(Vec3(-impulse)), toBullet(arm));
    }
}

}  // namespace cloth
