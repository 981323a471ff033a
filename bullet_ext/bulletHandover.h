#pragma once

#include <LinearMath/btScalar.h>

class btSoftBody;

namespace cloth {

/// Hands cloth over to Bullet's own code without a kick.
///
/// Our cloth rests some millimetres off what it lies on, Bullet's at its collision margin (0.25 m
/// unless it is set): Bullet would throw it out of the margin within a step. So the margin begins
/// with 4 mm and grows by 0.1 m/s to what it was. Bullet's links have other lengths, too: they
/// would be restored at once, with that velocity. So nodes are slowed down for half a second to the
/// speed that they had, and what gravity adds.
class BulletHandover {
 public:
    /// Nothing to hand over.
    BulletHandover() = default;
    /// From now on.
    explicit BulletHandover(btSoftBody& body);

    /// Before and after Bullet's code steps the body by h seconds.
    void beforeStep(btSoftBody& body, double h);
    void afterStep(btSoftBody& body, double h);
    /// The body has its margin again: it is not Bullet's any more.
    void end(btSoftBody& body);

 private:
    bool m_on = false;
    btScalar m_wanted = 0;  ///< margin of the user (m)
    btScalar m_given = 0;   ///< margin that it has now (m)
    double m_speed = 0.0;   ///< of the fastest node (m/s)
    double m_time = 0.0;    ///< since the handover (s)
};

}  // namespace cloth
