#include "bullet_ext/clothSleep.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>

#include "bullet_ext/softBodyGarment.h"

namespace cloth {

namespace {

constexpr double kLook = 0.5;  // s between two looks at how far the cloth has moved

bool readyToSleep(const btCollisionObject& object) {
    const int state = object.getActivationState();
    return object.isStaticOrKinematicObject() || state == ISLAND_SLEEPING ||
           state == WANTS_DEACTIVATION || state == DISABLE_SIMULATION;
}

/// Whether the object has moved more than a sleeping body may be pushed about.
bool moved(const btTransform& a, const btTransform& b) {
    constexpr btScalar kFar = 1e-4f;
    if ((a.getOrigin() - b.getOrigin()).length() > kFar) return true;
    for (int r = 0; r < 3; ++r)
        if ((a.getBasis()[r] - b.getBasis()[r]).length() > kFar) return true;
    return false;
}

}  // namespace

void ClothSleep::afterStep(const Points& x, double h, const BulletObstacles& obstacles,
                           const Vec3& low, const Vec3& high) {
    m_low = low;
    m_high = high;
    if (m_asleep) m_rest = 0.0;  // the user or the islands have woken it
    m_asleep = false;
    m_since_place += h;
    if (m_place.rows() == x.rows() && m_since_place < kLook) return;
    const bool still = m_place.rows() == x.rows() &&
                       (x - m_place).rowwise().squaredNorm().maxCoeff() < m_motion * m_motion;
    m_rest = still ? m_rest + m_since_place : 0.0;
    m_since_place = 0.0;
    if (!still) m_place = x;
    const int state = m_body.getActivationState();
    if (state == DISABLE_DEACTIVATION || gDisableDeactivation || !(gDeactivationTime > 0)) return;
    const bool rests = m_rest >= static_cast<double>(gDeactivationTime) &&
                       supportsRest(obstacles.objectsNear(m_body, low, high));
    if (rests && state == ACTIVE_TAG) m_body.setActivationState(WANTS_DEACTIVATION);
    if (!rests && state == WANTS_DEACTIVATION) m_body.setActivationState(ACTIVE_TAG);
}

bool ClothSleep::supportsRest(const std::vector<NearObject>& objects) const {
    for (int a = 0; a < m_body.m_anchors.size(); ++a)
        if (!readyToSleep(*m_body.m_anchors[a].m_body)) return false;
    for (const LinkAnchor& anchor : linkAnchors(m_body))
        if (!readyToSleep(*anchor.link)) return false;
    return std::all_of(objects.begin(), objects.end(), [](const NearObject& near) {
        return !near.moves && readyToSleep(*near.object);
    });
}

ClothSleep::Outside ClothSleep::look(const BulletObstacles& obstacles) const {
    Outside outside;
    outside.objects = obstacles.objectsNear(m_body, m_low, m_high);
    for (int a = 0; a < m_body.m_anchors.size(); ++a)
        outside.anchors.push_back(m_body.m_anchors[a].m_body->getWorldTransform());
    for (const LinkAnchor& anchor : linkAnchors(m_body))
        outside.anchors.push_back(anchor.link->getWorldTransform());
    outside.gravity = m_body.m_worldInfo->m_gravity;
    outside.wind = m_body.getWindVelocity();
    return outside;
}

bool ClothSleep::nodesMoved() const {
    const btVector3 zero(0, 0, 0);
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        const btSoftBody::Node& node = m_body.m_nodes[i];
        if (node.m_x != m_before.x[static_cast<size_t>(i)] || node.m_f != zero || node.m_v != zero)
            return true;
    }
    return false;
}

bool ClothSleep::outsideChanged(const Outside& now) const {
    if (now.gravity != m_before.gravity || now.wind != m_before.wind) return true;
    if (now.anchors.size() != m_before.anchors.size()) return true;
    for (size_t a = 0; a < now.anchors.size(); ++a)
        if (moved(now.anchors[a], m_before.anchors[a])) return true;
    if (now.objects.size() != m_before.objects.size()) return true;
    for (size_t i = 0; i < now.objects.size(); ++i) {
        const NearObject &a = now.objects[i], &b = m_before.objects[i];
        if (a.object != b.object || a.world_id != b.world_id || a.shape != b.shape || a.moves ||
            moved(a.pose, b.pose))
            return true;
    }
    return false;
}

bool ClothSleep::sleepsOn(const BulletObstacles& obstacles) {
    if (!m_asleep) {
        // What is left of its motion is not to go on when it wakes.
        for (int i = 0; i < m_body.m_nodes.size(); ++i) m_body.m_nodes[i].m_v.setZero();
        m_before = look(obstacles);  // without positions
        for (int i = 0; i < m_body.m_nodes.size(); ++i) m_before.x.push_back(m_body.m_nodes[i].m_x);
        m_asleep = true;
        return true;
    }
    const bool same_nodes = m_before.x.size() == static_cast<size_t>(m_body.m_nodes.size());
    if (same_nodes && !nodesMoved() && !outsideChanged(look(obstacles))) return true;
    wake();
    return false;
}

void ClothSleep::wake() {
    m_place.resize(0, 3);
    m_body.activate(/*forceActivation=*/true);
}

}  // namespace cloth
