#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "bullet_ext/anchoredBodies.h"
#include "bullet_ext/bodyGoals.h"
#include "bullet_ext/bulletObstacles.h"
#include "bullet_ext/clothSleep.h"
#include "bullet_ext/pinchedCloth.h"
#include "bullet_ext/rootMotion.h"
#include "bullet_ext/twoWayCoupling.h"
#include "gnn/deadline.h"
#include "gnn/stepper.h"

class btSoftBody;

namespace cloth {

/// Joins a Bullet soft body to the Stepper that moves it.
///
/// A world step of any length is served by a stepper with any time step. The stepper's steps
/// ("cloth steps") follow each other without gaps: a cloth step starts as soon as the world's time
/// passes the end of the last one, looks ahead with the velocities of obstacles and pins, and the
/// nodes show the straight line between the cloth step's two ends. So cloth and obstacles show the
/// same time; what an obstacle's acceleration changes within a cloth step is seen at the next one.
/// Steppers that are made for any time step use the world's, with no prediction at all; so do
/// steppers that accept any, where dynamic bodies are anchored to the cloth.
///
/// Whatever the user does to nodes between steps counts: moved or pushed free nodes start a new
/// cloth step from what the nodes say, pinned nodes are followed, node forces and wind act as
/// impulses. Dynamic rigid bodies get what they gave to the cloth, see TwoWayCoupling.
class SoftBodyStep {
 public:
    /// @param sleep_motion     cloth that moves less rests (m)
    /// @param sliding_friction  besides Coulomb's, see slidingFriction.h
    SoftBodyStep(btSoftBody& body, std::unique_ptr<const Garment> garment,
                 std::unique_ptr<Stepper> stepper, double sleep_motion, bool sliding_friction);

    /// Skinned goals of the garment's vertices; asked for if it has limits. Keeps a reference.
    void setGoals(std::shared_ptr<BodyGoals> goals) { m_goals = std::move(goals); }
    /// Keeps a reference. @param root  null: the cloth feels all of its motion
    void setRoot(std::shared_ptr<RootMotion> root) { m_root = std::move(root); }

    /// Goes on from where the nodes are, pins too: nothing was dragged there.
    void restart();

    const Garment& garment() const { return *m_garment; }
    const Stepper& stepper() const { return *m_stepper; }
    const Points& shown() const { return m_shown.x; }  ///< where the nodes are (|V| x 3, m)
    const Points& shownVelocities() const { return m_shown.v; }  ///< (|V| x 3, m/s)
    /// World steps that a cloth step is long, where its stepper takes steps of any length; the
    /// nodes are interpolated. From the next cloth step on.
    void setRate(int world_steps) {
        m_prepared = m_prepared && m_rate == world_steps;
        m_rate = world_steps;
    }
    Stepper& stepper() { return *m_stepper; }
    /// Whether other cloth is near, which may touch it: its steps then end with the world's, if its
    /// stepper takes steps of any length. From the next cloth step on.
    void setMeeting(bool meeting) {
        m_prepared = m_prepared && meeting == m_meeting;
        m_meeting = meeting;
    }
    /// A world step of h seconds in which the cloth is not stepped, but carried along as a whole:
    /// by its root, or by the means of its goals or pins. It then goes on from there.
    void carry(double h);
    /// Limits the time of the cloth steps of the next step(), see Stepper::set_max_ms().
    void setDeadline(const Deadline& deadline) { m_deadline = deadline; }
    const StepReport& lastReport() const { return m_report; }
    /// Impulse that dynamic rigid bodies got from the cloth in the last world step (N s).
    const Vec3& lastReaction() const { return m_reactions.lastImpulse(); }

    struct Result {
        int steps = 0;               ///< steps that the stepper made, 0 within a cloth step
        int failed_steps = 0;        ///< steps that it could not make: the cloth holds its shape
        int restored_nodes = 0;      ///< nodes that were not finite and were put back
        int caught_nodes = 0;        ///< nodes that pass through a solid, for want of room
        bool calmed = false;         ///< cloth and bodies would have made much energy
        bool unbalanced = false;     ///< nobody knows whether they did
        bool without_goals = false;  ///< the garment has limits, and goals were never given
        int stretched_anchor = -1;   ///< node that an anchor holds farther than the cloth reaches
        int idle_anchor = -1;        ///< node of an anchor that does nothing, see linkAnchors()
        bool left_behind = false;    ///< it was paused, and animated meshes at it went away
    };
    /// A world step of h seconds: takes over what the user changed, steps the cloth past the end of
    /// the world step and writes the nodes. Obstacles are looked for within `reach` (m):
    ///
    ///     step.begin(h, obstacles, reach);
    ///     while (step.beginClothStep(obstacles)) {
    ///         step.solve();
    ///         step.endClothStep(obstacles);
    ///     }
    ///     const SoftBodyStep::Result result = step.end(obstacles);
    ///
    /// solve() takes nearly all of the time, and several bodies may do it at the same time if they
    /// are independent; the other functions change the world.
    /// @return  false: nothing is to be stepped, as in a paused body
    bool begin(double h, BulletObstacles& obstacles, double reach);
    /// Whether the order in which this cloth and other independent cloth are stepped does not
    /// count: the stepper is independent, and this cloth moves no body of the world.
    bool isIndependent(const BulletObstacles& obstacles) const;
    /// The next cloth step; false: the cloth is past the end of the world step.
    bool beginClothStep(BulletObstacles& obstacles);
    void solve();
    void endClothStep(BulletObstacles& obstacles);
    Result end(BulletObstacles& obstacles);
    /// Whether begin() has begun a world step.
    bool isStepping() const { return m_begun; }
    /// After the cloth steps: dynamic bodies get what is theirs. Else end() does that.
    void handOver(BulletObstacles& obstacles);
    /// Between the last endClothStep() and end(): whether a cloth step ends with the world step.
    /// Only then takeContact() may be called.
    bool endsWithWorldStep() const;
    /// Whether forces, pins, goals or obstacles that move may have given the cloth energy in this
    /// world step.
    bool isWorkedOn() const { return m_worked_on; }
    /// Between the last endClothStep() and end(): what end() would show.
    ClothState endOfWorldStep() const;
    /// Before begin(): impulses of other cloth that the step has to expect (|V| x 3, N s).
    void expectContact(const Points& impulses) { m_expected = impulses; }
    /// Moves the cloth to where others have pushed it.
    /// @param x, v   |V| x 3 (m, m/s); pins where they are
    /// @param depth  of the deepest node in an obstacle then (m)
    void takeContact(const Points& x, const Points& v, double depth);
    /// Deepest node that is not pinned in an obstacle (m), as the last world step shows both. In
    /// animated meshes only what the last cloth step ended with is known.
    double shownDepth() const { return m_depth; }
    /// Whether cloth that Bullet has put to sleep may sleep on; if not, it is awake now.
    bool sleepsOn(const BulletObstacles& obstacles);

 private:
    struct Box {
        Vec3 low, high;
    };
    struct StepSpan {
        ClothState from, to;
        double begin = 0.0;   ///< relative to the start of the present world step (s)
        double length = 0.0;  ///< (s)
        bool valid = false;
    };

    int restoreNodes();
    void takeConstants();
    void takeNodes();
    void placePins();
    void takeWind();
    void keepWindFromGiving(const std::vector<btVector3>& before);
    void takeForces();
    void takePins();
    void followAnchors();
    Points pinsAt(double time) const;
    static Box boxAhead(const ClothState& state, double time, double reach);
    Boundary boundaryOfClothStep(BulletObstacles& obstacles);
    void addExpected(Points& accelerations);
    void startClothStep(bool first_of_step);
    void carryClothStep();
    bool looksAhead() const;
    bool hangsOnDynamicBody() const;
    double clothStepLength() const;
    Pose carryingMotion() const;
    void slowDown(BulletObstacles& obstacles);
    void writeNodes();
    void measureDepth(BulletObstacles& obstacles);
    int stretchedAnchor() const;
    std::vector<const btCollisionObject*> animatedNear(const BulletObstacles& obstacles) const;
    void pause(const BulletObstacles& obstacles);
    void resume(const BulletObstacles& obstacles);

    btSoftBody& m_body;
    std::unique_ptr<const Garment> m_garment;
    std::unique_ptr<Stepper> m_stepper;
    std::shared_ptr<BodyGoals> m_goals;
    std::shared_ptr<RootMotion> m_root;
    ClothState m_carried;  ///< where the present cloth step starts, with what carries it
    Deadline m_deadline;
    StepReport m_report;
    TwoWayCoupling m_reactions;
    PinchedCloth m_pinched;
    AnchoredBodies m_anchored;
    std::vector<NearSolid> m_solids;  ///< of the present cloth step, as the cloth sees them
    bool m_continues = false;         ///< the present cloth step starts where the last one ended
    ClothSleep m_sleep;
    bool m_sliding_friction;
    double m_time_scale = 1.0;  ///< time of the cloth over time of the world
    double m_depth = 0.0;       ///< shownDepth()
    double m_h = 0.0;           ///< the present world step, in the time of the cloth (s)
    double m_world_h = 0.0;     ///< the same in the time of the world
    double m_reach = 0.0;       ///< (m)
    bool m_begun = false;       ///< the present world step steps the cloth
    bool m_paused = false;      ///< the last one did not, for want of time
    std::vector<const btCollisionObject*> m_at_pause;  ///< animated meshes at it when that began
    bool m_handed_over = false;                        ///< in the present world step
    Box m_box;                    ///< where obstacles of the world step are looked for
    Result m_result;              ///< of the present world step
    Box m_cloth_box;              ///< where those of the present cloth step are
    Boundary m_boundary;          ///< of the present cloth step
    ClothState m_solved;          ///< its end, as the stepper has it
    bool m_hang = false;          ///< it is solved together with bodies on anchors
    int m_rate = 1;               ///< world steps in a cloth step
    bool m_worked_on = false;     ///< isWorkedOn()
    bool m_prepared = false;      ///< the stepper knows how long its steps are
    bool m_meeting = false;       ///< other cloth is near
    Points m_expected;            ///< |V| x 3 (N s) or empty, see expectContact()
    bool m_pushed = false;        ///< by other cloth, since the last cloth step
    double m_pushed_depth = 0.0;  ///< (m), see takeContact()
    StepSpan m_cloth_step;
    ClothState m_shown;    ///< what the nodes say, in doubles
    Points m_impulse;      ///< |V| x 3 (N s): forces of the world steps since the last cloth step
    Points m_pins_before;  ///< |pins| x 3 (m): at the start of the world step
    Points m_pins_after;   ///< at its end
    Points m_pins_at_cloth_step;   ///< m_pins_after in the first world step of the cloth step
    Points m_pins_drift;           ///< how far they moved in the rest of the last cloth step
    std::vector<float> m_written;  ///< |V| x 6: m_x and m_v as they were written
};

}  // namespace cloth
