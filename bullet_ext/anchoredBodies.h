#pragma once

#include <LinearMath/btVector3.h>

#include <vector>

#include "bullet_ext/rigidImpulse.h"
#include "gnn/stepper.h"

class btRigidBody;
class btSoftBody;

namespace cloth {

/// Finds the common step of cloth and the dynamic bodies that are anchored to it.
///
/// Bullet has moved the bodies as if there were no cloth, and the anchors hold the cloth where they
/// are: a light body would stretch stiff cloth by that to more energy than it has. So both are one
/// step of backward Euler: a body ends elsewhere than where Bullet put it, by
///
///     w = h M^-1 J(w)
///
/// with the impulse J that the cloth gives it in a step that ends there. Each trial of w is a step
/// of the cloth. The step is the minimum of an incremental potential, and BFGS finds it (Nocedal
/// and Wright, Numerical Optimization, 2006, section 6.1), in coordinates in which the mass of the
/// body and the anchored nodes is the identity. It goes on with the inverse Hessian of the last
/// step, and begins with one that is too stiff rather than too soft. A trial that makes energy is
/// cut, and steps are trusted no farther than trials have shown. A body so heavy that the cloth
/// hardly moves it takes one trial; others take up to eight of more accurate steps of the cloth,
/// each of which starts where the best one ended; none begins after 1,600 iterations. What is left
/// after that, TwoWayCoupling hands to body and cloth.
class AnchoredBodies {
 public:
    /// Bodies that hard anchors of the cloth hold, as Bullet has moved them.
    /// @param length of the cloth step (s)
    /// @return whether there are any
    bool begin(const btSoftBody& body, const Garment& garment, double length);

    /// Judges a cloth step.
    /// @param boundary of the step; pin targets become those of the next trial
    /// @param to       end of the step; if there is no other trial, that of the best one
    /// @param report   likewise
    /// @return         whether the step is to be taken again; never with a stepper that does not
    ///                 know the fabric's forces
    bool tryAgain(const Stepper& stepper, const ClothState& from, Boundary& boundary,
                  ClothState& to, StepReport& report);

    /// That the next step of the cloth should keep to, see Stepper::set_most_residual(). What pulls
    /// stiff cloth is known only where the step is near its minimum; steps that take one trial need
    /// no more than they do anyway.
    double mostResidual() const;

    /// Where the cloth step of the next trial may start (|V| x 3, m), once there was one.
    bool knowsStart() const { return m_best.x.rows() > 0; }
    const Points& nextStart() const { return m_best.x; }

    /// Moves the bodies to where the cloth step found them.
    /// @param to  end of the cloth step: anchored nodes are put on their anchors, to the bit
    void place(ClothState& to);

    /// By how much that changes the velocity of the body (m/s, 1/s); 0: it was not found.
    Vector6 changeOf(const btRigidBody& body) const;
    /// Energy that gravity put into the body by place() (J), with the sign of a gain.
    double liftOf(const btRigidBody& body) const;

 private:
    struct Anchor {
        int node;
        Eigen::Index pin;  ///< row of Boundary::pin_targets
        Vec3 arm;          ///< from the centre of mass, as Bullet has put the body (m)
        btVector3 local;   ///< in the frame of the body (m)
    };
    struct Hanging {
        btRigidBody* body;
        std::vector<Anchor> anchors;
        Eigen::Matrix3d frame;  ///< its principal axes
        Matrix6 carried;        ///< mass of the anchored nodes, about the body's centre
        Matrix6 root;           ///< root root': of it and the body, along these axes
        double lift;            ///< (J)
    };

    Vector6 wayOf(size_t body, const VectorX& u) const;
    Vec3 placeOf(const Hanging& hanging, const Anchor& anchor, const Vector6& way) const;
    Vec3 changeOf(Eigen::Index node, const Boundary& boundary, const ClothState& from,
                  const ClothState& to) const;
    VectorX residual(const Boundary& boundary, const ClothState& from, const ClothState& to) const;
    double energy(const Stepper& stepper, const Boundary& boundary, const ClothState& from,
                  const ClothState& to) const;
    void guessInverse();
    void findFollowing(const Points& x);
    void setInverse(size_t body, const Matrix6& mass, Eigen::MatrixXd& inverse) const;
    VectorX nextTrial(double merit);
    void updateInverse(const VectorX& s, const VectorX& y);
    void limit(VectorX& u) const;
    double motion(const VectorX& u0, const VectorX& u1) const;

    std::vector<Hanging> m_bodies;
    const Garment* m_garment = nullptr;
    VectorX m_masses;           ///< |V| (kg)
    double m_length = 0.0;      ///< (s)
    double m_mass_ratio = 1.0;  ///< massRatio()
    int m_trials = 0;
    int m_iterations = 0;  ///< of the trials of this step so far
    bool m_accurate = false;
    double m_trusted = 0.0;     ///< length of a step of u (sqrt J)
    Points m_internal;          ///< |V| x 3 (N)
    Eigen::MatrixXd m_inverse;  ///< of the Hessian; goes on with the next step
    double m_inverse_length = 0.0;
    Eigen::MatrixXd m_follows;  ///< the same, if only the mass of the cloth resisted
    VectorX m_u, m_last_u;      ///< 6 for each body (sqrt J): root w / h, along its principal axes
    VectorX m_residual;
    VectorX m_best_u, m_best_residual;
    double m_least = 0.0;  ///< its energy()
    ClothState m_best;
    StepReport m_best_report;
};

}  // namespace cloth
