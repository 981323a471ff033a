#pragma once

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bullet_ext/bulletHandover.h"
#include "bullet_ext/bulletObstacles.h"
#include "data/core/follower.h"
#include "data/core/garment.h"
#include "gnn/stepper.h"

namespace cloth {

class BodyGoals;
class ClothContacts;
class RootMotion;
class SkinBlend;
class SoftBodyStep;

/// Makes the stepper of one garment. The garment outlives the stepper.
using StepperFactory = std::function<std::unique_ptr<Stepper>(const Garment&)>;

}  // namespace cloth

/// What m_cfg.kDF times an object's friction means where cloth slides on the object.
enum class btGnnFriction {
    bullet,   ///< the larger of Coulomb's friction and Bullet's brake, see slidingFriction.h
    coulomb,  ///< Coulomb's coefficient, and nothing else
};

enum class btGnnTeleport {
    keep,  ///< the cloth keeps its shape and its velocities
    reset  ///< the cloth is where its goals are, and rests
};

struct btGnnSolverSettings {
    /// Of cloth that is attached without a fabric or a garment of its own; empty: what the body
    /// says, the materials of its links by the rule of materialFabric.h.
    std::optional<cloth::Fabric> fabric;
    bool useBodyDensity = false;  ///< true: `fabric` has the body's mass per area for its density;
                                  ///< false: the cloth moves as its fabric does, whatever it weighs
    btGnnFriction friction = btGnnFriction::bullet;
    double obstacleReach = 0.1;  ///< how far around cloth obstacles are looked for (m), 0.02 to 1
    double sleepMotion = 5e-3;   ///< cloth that moves less (m) for gDeactivationTime sleeps, 0 to
                                 ///< 0.05; 0: it never does
    /// Distance at which cloth bodies touch each other (m), 1e-3 to 0.02, where both ask for
    /// contact between soft bodies: VF_SS in m_cfg.collisions. 0: they pass through each other.
    double layerThickness = 4e-3;
    int maxFailedSteps = 3;  ///< failures in a row after which Bullet steps it, 1 to 1000000
    /// Bodies that push no rigid body, and have independent steppers, are stepped at the same time,
    /// see solveSteps() and cloth::Stepper::is_independent(). False, or with maxMs: all are stepped
    /// one after the other.
    bool parallel = true;
    /// Time for all cloth in a world step (ms), 0.1 to infinity (no limit). Each body gets an equal
    /// share of what is left; its steppers must know limits, see cloth::Stepper::set_max_ms(). What
    /// the cloth does then depends on how fast the machine is.
    double maxMs = std::numeric_limits<double>::infinity();
};

/// How much a body's cloth may cost: level of detail. See setDetail().
struct btGnnDetail {
    int iterations = 0;   ///< of each step, or part of one, at most, 1 to 1000; 0: as many as its
                          ///< stepper takes
    int worldSteps = 1;   ///< that a cloth step is long, 1 to 8; the nodes are interpolated
    bool stepped = true;  ///< false: it keeps its shape, and is carried along as a whole

    static btGnnDetail full() { return {}; }                  ///< near
    static btGnnDetail reduced() { return {3, 2, true}; }     ///< far
    static btGnnDetail offScreen() { return {0, 1, false}; }  ///< not seen
};

struct btGnnSolverMessage {
    std::string text;  ///< names the soft body, the problem and the remedy
    int count = 1;     ///< how often it was said
};

/// What the solver is doing; read it when you like, nothing in it has to be handled.
struct btGnnSolverStatus {
    int clothBodies = 0;      ///< stepped by a Stepper in the last world step
    int bulletBodies = 0;     ///< stepped by Bullet's own code
    int sleepingBodies = 0;   ///< of the cloth bodies, those that rest and cost nothing
    int carriedBodies = 0;    ///< of the cloth bodies, those that btGnnDetail::stepped keeps from
                              ///< being stepped
    int frozenBodies = 0;     ///< not stepped at all: positions, velocities or masses
                              ///< of their nodes are not finite
    long steps = 0;           ///< calls of Stepper::step() so far
    long failedSteps = 0;     ///< those that failed
    long cutSteps = 0;        ///< those that were taken in parts, see cloth::ClothStepper
    long shortenedSteps = 0;  ///< those that btGnnSolverSettings::maxMs ended early
    int touchingPairs = 0;    ///< of edges, and of nodes and faces, of different cloth bodies that
                              ///< touched each other in the last world step
    int passedPairs = 0;      ///< of these, those that passed through each other for want of room
    double maxPenetration = 0.0;  ///< deepest cloth node in an obstacle, as the last world step
                                  ///< shows both (m); limbs that it ignores do not count
    /// Deepest cloth node inside a limb that it ignores (m): where limbs of a character pass
    /// through each other there is no room for cloth, see cloth::LimbOverlap.
    double maxIgnoredDepth = 0.0;
    int nodesInIgnoredLimbs = 0;  ///< nodes inside such limbs, all cloth together
    cloth::StageTimes times;      ///< of the last world step, summed over all cloth, also where
                                  ///< bodies were stepped at the same time
    std::vector<btGnnSolverMessage> messages;
};

/// Steps the cloth of a btSoftRigidDynamicsWorld, or a btSoftMultiBodyDynamicsWorld, with any
/// cloth::Stepper, learned or not; hand it to the world in place of Bullet's own solver:
///
///     btGnnSoftBodySolver solver([](const cloth::Garment& garment) {
///         return cloth::make_cloth(garment);
///     });
///     btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
///     world.addSoftBody(shirt);
///
/// - Cloth is a soft body with faces and without tetrahedra, clusters, joints, pressure, volume
///   conservation and pose matching. Its surface has a border; a closed one, which Bullet's links
///   hold up, is cloth if attach() says so. All other soft bodies, and cloth that cannot be a
///   garment, are stepped by Bullet's own code, body by body, as by btDefaultSoftBodySolver.
/// - Pins are nodes of zero inverse mass (moved by their velocity or by setting m_x) and anchored
///   nodes (moved by their rigid body); anchors of influence below 1 pull, see softAnchors.h.
/// - Obstacles are the world's collision objects; see BulletObstacles. Dynamic rigid bodies get
///   what contacts and anchors took from them, see TwoWayCoupling. Cloth touches cloth where both
///   have VF_SS, see btGnnSolverSettings::layerThickness, and passes through other soft bodies.
/// - Gravity is that of the soft body's btSoftBodyWorldInfo (as for Bullet's own soft bodies, and
///   -10 until set), not the world's. Wind, node forces, kDP damping, kDF friction and timescale
///   act as in Bullet. The cloth is as stiff as its m_materials say, by the rule of
///   materialFabric.h, or has a fabric in SI units: attach() and btGnnSolverSettings::fabric.
/// - Skinned goals, as games paint them on clothes: setGoalLimits() and setGoals().
/// - Cloth that rests sleeps and costs nothing until something about it changes, see ClothSleep.
/// - The rest shape is the shape of the first step. Later transform() and translate() move the
///   cloth and leave its rest shape; scale() and setRestLengthScale() by more than 10 % scale it.
///   Nodes that a cut adds get the rest positions of the places that they cut.
///
/// Remove soft bodies from the world before deleting them, and keep the solver until then.
class btGnnSoftBodySolver : public btDefaultSoftBodySolver {
 public:
    /// @throws cloth::ArgumentError if there is no factory or a setting is out of range
    explicit btGnnSoftBodySolver(cloth::StepperFactory factory, btGnnSolverSettings settings = {});
    ~btGnnSoftBodySolver() override;

    /// Takes a cloth body now rather than at its first step, so that errors are thrown here.
    /// @throws cloth::ArgumentError naming the body, what is wrong with it and the remedy
    void attach(btSoftBody* body);
    /// The same with the body's garment (its rest shape and fabric; pins are taken from the body)
    /// and, if given, its own kind of stepper. It holds until the body leaves the world.
    void attach(btSoftBody* body, const cloth::Garment& garment,
                cloth::StepperFactory factory = nullptr);
    /// The same with a fabric of its own: nothing of it is taken from settings, materials or
    /// masses.
    void attach(btSoftBody* body, const cloth::Fabric& fabric,
                cloth::StepperFactory factory = nullptr);
    /// Leaves the body to Bullet's own code from now on.
    void detach(btSoftBody* body);
    /// Drops all that was asked of a body, as its removal from the world does. To be called where a
    /// body that was attached, or of which something was set, is deleted and never was in a world,
    /// or was detached since its last step: the next body of as many nodes and faces at its address
    /// would be taken for it.
    void forget(const btSoftBody* body);

    /// The stepper and garment of a body; null if Bullet steps it.
    const cloth::Stepper* stepperOf(const btSoftBody* body) const;
    const cloth::Garment* garmentOf(const btSoftBody* body) const;
    /// Report of the body's last step; null if there was none.
    const cloth::StepReport* reportOf(const btSoftBody* body) const;
    /// The hierarchies of the world's mesh obstacles, which all cloth shares: what they cost.
    const cloth::ObstacleTrees& obstacleTrees() const { return *m_obstacles.trees(); }

    /// Gives the surface of an animated obstacle before each stepSimulation(): it replaces the
    /// shape of `object` (any object of the world; its collision filter and friction are used).
    /// If x0 is not where the surface was at the end of the last step, it goes from there to x1, or
    /// jumps: see cloth::AnimatedObstacle.
    /// @param faces     (|F| x 3), the same pointer in every call
    /// @param x0, x1    vertices now and after `duration` seconds (|V| x 3, m, world frame)
    /// @param duration  usually the time of the stepSimulation() that follows; 0: one sub-step
    /// @param limbs     limb of each face (|F|, 0 to 31), the same pointer in every call, or null.
    ///                  With them, cloth passes through limbs that are inside other limbs instead
    ///                  of being dragged along: see cloth::LimbOverlap
    void setAnimatedObstacle(const btCollisionObject* object,
                             std::shared_ptr<const cloth::Faces> faces, cloth::Points x0,
                             cloth::Points x1, double duration = 0.0,
                             std::shared_ptr<const std::vector<std::uint8_t>> limbs = nullptr);
    /// Call before the object is deleted. While an object that was in the world is not, its surface
    /// is no obstacle.
    void removeAnimatedObstacle(const btCollisionObject* object);

    /// Limits the cloth of a body by skinned goals, see cloth::GoalLimits; empty limits: no more.
    /// To be set once: its stepper is built anew. attach() with a garment that has limits does the
    /// same.
    /// @param limits  one value per node in each array, or none
    /// @throws cloth::ArgumentError if the body is null, an array has a wrong size or a value is
    ///         out of range
    void setGoalLimits(btSoftBody* body, const cloth::GoalLimits& limits);
    /// Gives the goals of the body's nodes before each stepSimulation(), as setAnimatedObstacle()
    /// gives skin. Goals that are not given anew stand still. Before they are given for the first
    /// time, they are where the nodes are then.
    ///
    /// In an obstacle there is no room for cloth: it stays outside, beyond its limits if need be.
    /// @param goals     now and after `duration` seconds (|nodes| x 3, m, world frame)
    /// @param duration  usually the time of the stepSimulation() that follows; 0: one sub-step
    /// @throws cloth::ArgumentError if the body is null, an array has a wrong size or a number is
    ///         not finite
    void setGoals(btSoftBody* body, cloth::SkinGoals goals, double duration = 0.0);
    /// How much of its root's motion a body's cloth feels, 1 until set: with less, cloth of a
    /// character that runs or rides hangs and swings as on one that goes slowly. The rest of the
    /// motion carries the cloth along. Gravity, goals, pins and obstacles count as ever.
    /// @param linear, angular  shares of displacement and turn, 0 to 1
    /// @throws cloth::ArgumentError if the body is null or a share is out of range
    void setInertia(btSoftBody* body, double linear, double angular);
    /// Gives the root's motion before each stepSimulation(), such as that of the character's hips;
    /// a root that is not given anew stands still.
    /// @param from, to  now and after `duration` seconds, in the world
    /// @throws cloth::ArgumentError if the body is null, a number is not finite, or a pose scales
    void setRootMotion(btSoftBody* body, const btTransform& from, const btTransform& to,
                       double duration = 0.0);
    /// How much a body's cloth may cost from now on; switch it whenever you like: nothing jumps.
    ///
    ///     solver.setDetail(shirt, distance < 10 ? btGnnDetail::full() : btGnnDetail::reduced());
    ///
    /// - Fewer iterations: softer and more damped cloth. XPBD, Bullet's cloth and Newton's method
    ///   take no notice, with a message.
    /// - Longer cloth steps foresee obstacles, pins and goals by their velocities, damp more, and
    ///   are cut where something moves fast. Steppers with a time step of their own that is about
    ///   as long keep to it. Cloth that a dynamic body hangs on is stepped with the world.
    /// - Cloth that is not stepped moves with its root (setRootMotion()), or else as far as the
    ///   mean of its goals, or of its pins; pins stay exact. Stepped again, it goes on from there
    ///   with the velocity of that motion. Skin may have moved into it: teleport() by
    ///   btGnnTeleport::reset puts it on its goals.
    ///
    /// A proxy is a matter of attach(): with a stepper that embeds the body's own mesh in one (see
    /// cloth::EmbeddedStepper) the nodes go on from where they are.
    /// @throws cloth::ArgumentError if the body is null or a value is out of range
    void setDetail(btSoftBody* body, const btGnnDetail& detail);
    /// Lets something follow a body's nodes, such as the mesh to be drawn where the soft body is a
    /// coarse proxy of it, see cloth::EmbeddedMesh and cloth::make_proxy():
    ///
    ///     auto drawn = std::make_shared<cloth::EmbeddedMesh>(coarse.rest(), fine.rest());
    ///     solver.follow(shirt, drawn);
    ///     world.stepSimulation(dt);
    ///     draw(drawn->vertices(), drawn->normals(), drawn->faces());
    ///
    /// It is shown the nodes and all obstacles now, after teleport(), and after each world step in
    /// which the body is not asleep, Bullet's own steps too. Moving, scaling and new pins are
    /// followed. It ends when the number of nodes changes, as by a cut, with a message, and when
    /// the body leaves the world. It counts in the times of contact, but not for maxMs.
    /// @param follower  of as many vertices as the body has nodes, in their order; null: no more
    /// @throws cloth::ArgumentError if the body is null or the follower is of another number
    void follow(btSoftBody* body, std::shared_ptr<cloth::Follower> follower);
    /// What follows a body; null: nothing does, or it has ended.
    const cloth::Follower* followerOf(const btSoftBody* body) const;
    /// Lets what is shown of a body fade from where its cloth is simulated to where its goals are,
    /// or back: see cloth::SkinBlend. The cloth itself is not changed by it, and goes on.
    ///
    ///     solver.fadeToSkin(shirt, 1.0, 0.5);   // skinned in half a second
    ///     solver.setGoals(shirt, goals, dt);    // before each step, as for limits
    ///     world.stepSimulation(dt);
    ///     draw(solver.shownPositions(shirt));   // in place of the nodes
    ///
    /// What follows the body, see follow(), follows what is shown. No vertex of it is inside an
    /// obstacle. The body need not have limits. A body that Bullet steps is shown as it is.
    /// @param weight   0: simulated, as it is until this is called; 1: on the goals
    /// @param seconds  of the world's time, 0 to 1e6; 0: at once, from the next world step on
    /// @throws cloth::ArgumentError if the body is null or a number is out of range
    void fadeToSkin(btSoftBody* body, double weight, double seconds = 0.0);
    /// Where a body is shown: its nodes, or what fadeToSkin() made of them (|nodes| x 3, m, in the
    /// world), as of the last world step.
    /// @throws cloth::ArgumentError if the body is null
    cloth::Points shownPositions(const btSoftBody* body) const;
    /// Moves a body at once, without what cloth does when it is dragged there: where its character
    /// was put elsewhere. setGoals() and setAnimatedObstacle() then go on from the new place.
    ///
    /// keep: all nodes are moved by `motion`, and what they did turns with them. reset: they are
    /// put on their goals, moved by `motion`, and rest. That needs goals, limited or not; a body
    /// without goals keeps its shape, with a message, and rests.
    /// @throws cloth::ArgumentError if the body is null, or the motion is not finite or scales
    void teleport(btSoftBody* body, const btTransform& motion,
                  btGnnTeleport kind = btGnnTeleport::keep);

    const btGnnSolverStatus& status() const { return m_status; }
    void clearMessages() { m_status.messages.clear(); }

    bool checkInitialized() override { return true; }
    void optimize(btAlignedObjectArray<btSoftBody*>& softBodies, bool forceUpdate = false) override;
    void predictMotion(btScalar solverdt) override;
    void solveConstraints(btScalar solverdt) override;
    void updateSoftBodies() override;
    void processCollision(btSoftBody* body, const btCollisionObjectWrapper* object) override;
    void processCollision(btSoftBody* body, btSoftBody* otherBody) override;

 private:
    enum class Stepping { cloth, bullet, frozen };
    struct Entry {
        Stepping stepping = Stepping::bullet;
        bool detached = false;  ///< the user chose Bullet
        bool asked = false;     ///< the user chose cloth
        int worldId = 0;        ///< of the body in its world; 0: not seen there yet
        long mesh = 0;          ///< meshSizeOf() when it was asked for in no world; 0: any
        bool seen = false;      ///< was part of the world
        std::unique_ptr<cloth::SoftBodyStep> step;
        std::shared_ptr<const cloth::Garment> given;  ///< by the user, else null
        std::optional<cloth::Fabric> fabric;          ///< the body's own
        cloth::StepperFactory factory;                ///< the body's own, else null
        std::optional<cloth::GoalLimits> limits;      ///< by the user
        std::shared_ptr<cloth::RootMotion> root;      ///< null: nobody asked for it
        std::shared_ptr<cloth::BodyGoals> goals;      ///< null: nobody asked for goals
        std::shared_ptr<cloth::Follower> follower;    ///< null: nobody asked for one
        std::shared_ptr<cloth::SkinBlend> blend;      ///< null: nobody asked for it
        btGnnDetail detail;
        cloth::BulletHandover handover;
        size_t topology = 0;
        std::vector<double> restLengths;  ///< of its links at the last step (m)
        int failures = 0;                 ///< in a row
        long built = 0;                   ///< the number of this stepper in the solver
        bool meets = false;               ///< other cloth is near
        bool waits = false;               ///< to be finished when contacts are resolved
        bool placed = false;              ///< by teleport(), since the last world step
    };

    Entry& entryOf(const btSoftBody* body);
    Entry& entryToSet(const btSoftBody& body);
    void build(btSoftBody& body, Entry& entry);
    void leaveToBullet(btSoftBody& body, Entry& entry);
    void followCut(btSoftBody& body, Entry& entry);
    double scaleOf(const btSoftBody& body, Entry& entry) const;
    cloth::Garment garmentFor(const btSoftBody& body, const Entry& entry) const;
    void tryBuild(btSoftBody& body, Entry& entry);
    void refresh(btSoftBody& body, Entry& entry);
    void followScale(btSoftBody& body, Entry& entry);
    int activeCloth() const;
    struct Stepped {
        btSoftBody* body;
        Entry* entry;
    };
    void stepTogether(const std::vector<Stepped>& cloth);
    void finishStep(const Stepped& cloth);
    std::vector<std::vector<Stepped>> findMeetingCloth();
    void resolveContacts(std::vector<Stepped> group);
    const std::shared_ptr<cloth::BodyGoals>& goalsOf(const btSoftBody& body, Entry& entry);
    void joinGoals(btSoftBody& body, Entry& entry);
    cloth::RootMotion& rootOf(Entry& entry);
    void applyDetail(const btSoftBody& body, Entry& entry);
    void tellOfPlace(const btSoftBody& body);
    void tellOfJumps(const btSoftBody& body, Entry& entry);
    bool isStepped(const btSoftBody* body) const;
    void showFollower(const btSoftBody& body, Entry& entry);
    void showWithoutObstacles(const btSoftBody& body, Entry& entry);
    void giveUp(btSoftBody& body, Entry& entry, const std::string& why);
    void say(const std::string& text);
    Stepping steppingOf(const btSoftBody* body) const;

    cloth::StepperFactory m_factory;
    btGnnSolverSettings m_settings;
    btGnnSolverStatus m_status;
    cloth::BulletObstacles m_obstacles;
    std::unique_ptr<cloth::ClothContacts> m_contacts;  ///< null: cloth does not touch cloth
    long m_built = 0;                                  ///< steppers so far
    double m_h = 0.0;                                  ///< the last world step (s)
    std::map<const btSoftBody*, Entry> m_entries;
};
