#pragma once

#include <array>
#include <map>
#include <vector>

#include "bullet_ext/clothStep.h"
#include "bullet_ext/contactVelocities.h"
#include "bullet_ext/energyBalance.h"
#include "bullet_ext/rigidImpulse.h"

class btRigidBody;
class btSoftBody;

namespace cloth {

/// Gives dynamic rigid bodies the impulses that contacts and anchors took from them.
///
/// What a step changed in a node's momentum, less gravity, node forces and the fabric's own forces,
/// came from outside: from what the node is anchored to or touches (itself, or the middle of an
/// edge or face of it). Other nodes have such a rest where the stepper did not converge; it is that
/// of the nearest node that is held. Cloth that is pinched between a body and a solid that
/// nothing can push hands nothing on: the two touch each other through it, and Bullet's own contact
/// pushes them apart.
/// What contacts give keeps within Coulomb's cone: it pushes, and rubs by no more than the friction
/// of both. Momentum is counted in the masses that the cloth moves with: the soft body's mass,
/// spread over its nodes like the garment's, which is by area. Where nothing but dynamic bodies
/// supports the cloth, it is conserved to rounding. Counted in node masses of another spread, as
/// setTotalMass() without `fromfaces` makes them, it would come and go as the cloth waves.
///
/// The stepper took the body's motion as given, however light the body is. So body and cloth are
/// brought to a common motion afterwards, as in an inelastic collision: with the impulse J that the
/// nodes took, both get the change of velocity d,
///
///     (M + sum w_i m_i J_i' J_i) d = J,   v_i += w_i J_i d
///
/// M is the body's mass matrix (6 x 6), m_i a node's mass, J_i takes the body's velocity to that of
/// node i. Nodes that the body holds have w = 1. Cloth that an anchor pulls follows as far as a
/// stretch wave runs in the cloth step: w falls from 1 at the anchor, whose motion counts, to 0
/// there. Without that a light body on stiff cloth would be thrown about.
///
/// No contact throws cloth, see calmContacts(); and cloth and bodies make no energy, see
/// EnergyBalance. What something else has stopped before all of an impulse was handed over, gets
/// no more of it than keeps to that.
///
/// Where a cloth step is a world step, bodies that the cloth is anchored to have moved with it, see
/// AnchoredBodies: they get what that took, and d is for the rest of J.
///
/// Steppers without internal_forces(), such as XPBD, push what touches the cloth; what is anchored
/// to it feels nothing: the balance of a single node would be all noise.
class TwoWayCoupling {
 public:
    explicit TwoWayCoupling(btSoftBody& body) : m_body(body) {}

    /// Finds the impulses of a cloth step.
    void collect(const ClothStep& step);
    /// Hands over the part that belongs to a world step of h seconds. Bodies that are neither
    /// anchored to nor near the cloth any more get nothing.
    void apply(double h, const std::vector<NearSolid>& near);

    /// Impulse given to rigid bodies in the last apply() (N s).
    const Vec3& lastImpulse() const { return m_last_impulse; }
    /// Whether the last cloth step would have made energy, more than rounding and unconverged
    /// steps do, which was taken away.
    bool calmed() const { return m_calmed; }
    /// Whether bodies got something in the last cloth step that was not balanced, for the stepper
    /// does not know its energy.
    bool unbalanced() const { return m_unbalanced; }
    /// Whether the cloth was held back for that, and may be inside a body.
    bool heldBack() const { return m_held_back; }
    /// Bodies that were held back with it: Bullet had moved them farther.
    const std::vector<const btRigidBody*>& heldBodies() const { return m_held_bodies; }

 private:
    /// Cloth that follows the body: at a place of it (m, from its centre), with a part of its mass.
    struct Follower {
        int node;
        Vec3 arm;
        double weight;
    };
    /// Nodes that touch one side of a body: single impulses are noisy and cancel within it.
    struct Side {
        Vec3 impulse = Vec3::Zero();  ///< on the body (N s)
        Vec3 normal = Vec3::Zero();   ///< sum over the nodes, away from the body
        Vec3 arm = Vec3::Zero();      ///< sum over the nodes, from the body's centre (m)
        int count = 0;
    };
    struct Account {
        std::array<Side, 6> sides;          ///< by the direction that the normal is nearest to
        Vector6 taken = Vector6::Zero();    ///< impulse of this cloth step (N s, N m s)
        Vector6 planned = Vector6::Zero();  ///< what the rest of the present cloth step hands over
        double plan_time = 0.0;             ///< that rest (s)
        double gain = 0.0;                  ///< energy that it may give the body (J)
        double lift = 0.0;                  ///< energy that the body got by being moved (J)
        std::vector<int> nodes;             ///< that touch the body or are anchored to it
        double meeting = 0.0;               ///< fastest that body and nodes met (m/s)
        bool anchored = false;
    };

    void forgetAbsent(const std::vector<NearSolid>& near);
    void balanceAlone(const ClothStep& step);
    void forgetHolders(size_t nodes);
    void findHolders(const ClothStep& step);
    void holdByAnchors();
    void findFreeVelocities(const ClothStep& step);
    void moveAnchored(const ClothStep& step);
    void keepMomentum(const ClothStep& step);
    Vec3 withinFriction(const btRigidBody& body, const Vec3& normal, const Vec3& impulse) const;
    void chargeSide(const ClothStep& step, int node, const Vec3& impulse, Account& account) const;
    void closeSides(const btRigidBody& body, Account& account) const;
    bool isPinched(const ClothStep& step, int node, const NearSolid& holder) const;
    void releasePinching(const ClothStep& step);
    void findImpulses(const ClothStep& step);
    void charge(const ClothStep& step, int node);
    void findOwners(const ClothStep& step);
    std::vector<Follower> followersOf(const ClothStep& step, const btRigidBody& body,
                                      const Account& account) const;
    void settle(const ClothStep& step, btRigidBody& body, Account& account);
    void returnToCloth(const ClothStep& step, const Vec3& impulse);
    void balanceEnergy(const ClothStep& step);
    bool presses(const ClothStep& step, const NearSolid& solid) const;
    bool bodiesWait(const ClothStep& step) const;
    void holdBodies(const ClothStep& step, double way);
    double workFromOutside(const ClothStep& step) const;

    btSoftBody& m_body;
    EnergyBalance m_energy;
    VectorX m_masses;           ///< |V| (kg): 0 for nodes that nothing can move
    double m_mass_ratio = 1.0;  ///< of this cloth step, massRatio()
    std::map<btRigidBody*, Account> m_accounts;
    std::vector<btRigidBody*> m_holder;          ///< |V|: null: no body that can be pushed
    std::vector<char> m_held;                    ///< |V|: by anything at all
    std::vector<std::vector<int>> m_neighbours;  ///< |V|
    std::vector<int> m_owner, m_queue;           ///< |V|: the held node a node belongs to, or -1
    std::vector<double> m_distance;              ///< |V| (m): to the holder
    ClothTouches m_touches;
    Points m_impulses;  ///< |V| x 3 (N s): from outside
    Points m_internal;  ///< |V| x 3 (N)
    Points m_free;      ///< |V| x 3 (m/s): velocities, had nothing from outside held the cloth
    bool m_internal_known = false;
    Vec3 m_last_impulse = Vec3::Zero();
    bool m_floats = false;  ///< nothing but bodies that can be pushed holds the cloth
    bool m_calmed = false, m_held_back = false, m_unbalanced = false;
    std::vector<const btRigidBody*> m_held_bodies;
};

}  // namespace cloth
