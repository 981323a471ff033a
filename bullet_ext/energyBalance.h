#pragma once

#include <map>
#include <optional>
#include <vector>

#include "bullet_ext/clothStep.h"
#include "bullet_ext/rigidImpulse.h"

namespace cloth {

/// The last limit of two-way coupling: what cloth and bodies have after a cloth step, they had
/// before it, or the world put it in. Energy that came from nowhere is taken from the motion of the
/// cloth, without changing its momentum where nothing else holds it, then from what bodies gain,
/// then from all motion of bodies that the cloth is anchored to, and from that of bodies that press
/// into cloth which nothing else bears. Where the fabric itself took up more than that, and there
/// is ground that can bear the bodies, the cloth does not go all the way: rather inside a body for
/// a while than thrown. Where nothing else bears the bodies, they go as far as the cloth, and keep
/// that part of their motion.
/// What would lift the cloth by little more than a centimetre, as contacts do that push it out, is
/// owed there, and where bodies are anchored. Where no body can be pushed, what would lift it by a
/// hundredth of its edges is paid when it becomes motion, all else by any motion.
///
/// Where bodies are anchored, what was lost lately may come back, a third of so much. Bullet's step
/// of a body that falls loses energy: what holds the body up gives that back.
///
/// Bullet pushes bodies that lie in hanging cloth about all the time, and that is work: there what
/// is made is taken only where it has added up to more than that.
///
/// A body that lies on something is pushed by the cloth on it and stopped by what it lies on, again
/// and again. What it gained in the last step and lost since, it may gain in this one.
///
/// The fabric takes part in the balance, so its energy has to be known, and all that the cloth
/// touches: without Stepper::internal_energy(), near animated meshes, or with skinned goals,
/// nothing is done.
class EnergyBalance {
 public:
    /// A body that an impulse is planned for.
    struct Share {
        const btRigidBody* body;
        Vector6* impulse;  ///< changed
        bool anchored;     ///< to the cloth
        double lift;       ///< energy that it got by being moved (J)
    };
    struct Cloth {
        const VectorX& masses;  ///< |V| (kg), 0: nothing moves the node
        double mass_ratio;      ///< massRatio()
        double work;            ///< that the world put into it during the step (J)
        bool floats;            ///< nothing that cannot be pushed holds it
        bool bodies_wait;       ///< bodies that press into it can be held back with it
    };

    struct Result {
        bool much = false;      ///< the step made much more than there was in the cloth's motion
        bool held = false;      ///< the cloth was held back
        bool together = false;  ///< and bodies that press into it have to be
        double way = 1.0;       ///< part of its way that it went
        bool limited = false;   ///< impulses were changed
        bool unknown = false;   ///< the stepper does not know the fabric's energy
    };
    /// Takes energy that the step made from velocities and impulses, and from the way of the cloth.
    Result settle(const ClothStep& step, const Cloth& cloth, std::vector<Share>& shares);
    /// The next step pays for what bodies got since (J).
    void owe(double energy) { m_debt += energy; }
    /// The next step does not go on from the last one.
    void forget() { m_elastic.reset(); }

 private:
    struct Pushed {
        double gain;    ///< (J)
        Vector6 after;  ///< motion
    };
    Result balance(const ClothStep& step, const Cloth& cloth, std::vector<Share>& shares);
    double borneBefore(const Share& share, double length) const;

    std::optional<double> m_elastic;                ///< of the fabric after the last cloth step (J)
    double m_debt = 0.0;                            ///< energy that could not be taken yet (J)
    std::map<const btRigidBody*, Pushed> m_pushed;  ///< in the last cloth step
};

}  // namespace cloth
