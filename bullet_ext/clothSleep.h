#pragma once

#include <vector>

#include "bullet_ext/bulletObstacles.h"
#include "data/core/cloth_state.h"

class btSoftBody;

namespace cloth {

/// Lets cloth that rests fall asleep, as Bullet's rigid bodies do, and wakes it.
///
/// Cloth rests when no node has left a small ball around its place for Bullet's deactivation time
/// (gDeactivationTime, 2 s) and the dynamic bodies near or anchored to it are ready to sleep, too.
/// Then its activation state becomes WANTS_DEACTIVATION and Bullet's islands put it to sleep
/// together with what it lies on. It wakes when a node, force, pin, anchor, gravity, wind or an
/// object near it changes. DISABLE_DEACTIVATION and gDisableDeactivation keep it awake.
class ClothSleep {
 public:
    ClothSleep(btSoftBody& body, double motion) : m_body(body), m_motion(motion) {}

    /// After a world step of h seconds. @param x  |V| x 3 (m)
    void afterStep(const Points& x, double h, const BulletObstacles& obstacles, const Vec3& low,
                   const Vec3& high);
    /// Whether sleeping cloth may sleep on; if not, it is woken.
    bool sleepsOn(const BulletObstacles& obstacles);

 private:
    struct Outside {
        std::vector<NearObject> objects;
        std::vector<btTransform> anchors;
        btVector3 gravity, wind;
        std::vector<btVector3> x;  ///< |V| (m)
    };

    bool supportsRest(const std::vector<NearObject>& objects) const;
    Outside look(const BulletObstacles& obstacles) const;
    bool nodesMoved() const;
    bool outsideChanged(const Outside& now) const;
    void wake();

    btSoftBody& m_body;
    double m_motion;             ///< radius of the ball (m)
    Points m_place;              ///< |V| x 3 (m): its middles
    double m_since_place = 0.0;  ///< (s)
    double m_rest = 0.0;         ///< how long the cloth has rested (s)
    bool m_asleep = false;
    Vec3 m_low = Vec3::Zero(), m_high = Vec3::Zero();  ///< where objects matter (m)
    Outside m_before;                                  ///< when it fell asleep
};

}  // namespace cloth
