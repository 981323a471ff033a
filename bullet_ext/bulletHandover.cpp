#include "bullet_ext/bulletHandover.h"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>

namespace cloth {

namespace {

constexpr btScalar kFirstMargin = btScalar(4e-3);  // m, at which our cloth rests
constexpr double kGrowth = 0.1;                    // m/s
constexpr double kCalm = 0.5;                      // s

}  // namespace

BulletHandover::BulletHandover(btSoftBody& body) : m_on(true) {
    m_wanted = body.getCollisionShape()->getMargin();
    m_given = std::min(m_wanted, kFirstMargin);
    body.getCollisionShape()->setMargin(m_given);
    for (int i = 0; i < body.m_nodes.size(); ++i)
        m_speed = std::max(m_speed, static_cast<double>(body.m_nodes[i].m_v.length()));
}

void BulletHandover::beforeStep(btSoftBody& body, double h) {
    if (!m_on) return;
    m_time += h;
    m_speed += h * static_cast<double>(body.m_worldInfo->m_gravity.length());
    btCollisionShape& shape = *body.getCollisionShape();
    if (shape.getMargin() != m_given) {  // the user has set another
        m_wanted = m_given = shape.getMargin();
    } else if (m_given < m_wanted) {
        m_given = std::min(m_wanted, m_given + static_cast<btScalar>(kGrowth * h));
        shape.setMargin(m_given);
    }
    if (m_given >= m_wanted && m_time > kCalm) m_on = false;
}

void BulletHandover::afterStep(btSoftBody& body, double h) {
    if (!m_on || m_time > kCalm) return;
    const auto most = static_cast<btScalar>(m_speed);
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body.m_nodes[i];
        const btScalar speed = node.m_v.length();
        if (!(speed > most)) continue;
        node.m_v *= most / speed;
        if (node.m_im > 0) node.m_x = node.m_q + node.m_v * static_cast<btScalar>(h);
    }
}

void BulletHandover::end(btSoftBody& body) {
    btCollisionShape& shape = *body.getCollisionShape();
    if (m_on && shape.getMargin() == m_given) shape.setMargin(m_wanted);
    m_on = false;
}

}  // namespace cloth
