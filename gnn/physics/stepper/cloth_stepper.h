#pragma once

#include <limits>
#include <memory>

#include "collision/ccd/tunnelling.h"
#include "collision/proximity/limb_overlap.h"
#include "collision/proximity/obstacle_trees.h"
#include "collision/response/neighbour_pull.h"
#include "gnn/physics/stepper/boundary_part.h"
#include "gnn/physics/stepper/step_solver.h"

namespace cloth {

/// When a step is corrected, and when it is cut into parts.
///
/// Where a few points of the garment went through a solid, they are moved back to where they went
/// in. A step that went past a surface, or of which more went through, or of which some have no
/// room where they went in, is taken on from where it ended, with the contacts that hold it there.
/// That costs about half a step more. If more than a few points still went through, it is taken
/// again in parts, which are not corrected; a few, such as in a fold of skin that closes on them,
/// stay, and are reported.
struct GuardSettings {
    bool limbs = true;  ///< limbs of a body that pass through each other are told apart, see
                        ///< LimbOverlap
    /// Steps in which an obstacle near the garment, or a pin, moves farther than this (m, relative
    /// to the garment) are cut, 0.01 to 1. Contacts are found at the start of a step within the
    /// proximity's radius: what comes from farther away would pass through. The parts are taken in
    /// the small steps that the settings ask for; where the cloth hardly moves, or touches itself,
    /// or these are of Newton's method, or of a network for another length, in one of `iterations`.
    double max_motion = 0.1;
    /// Steps that leave a vertex deeper inside an obstacle than this (m, before contact projection)
    /// went past a surface, 1e-3 to 0.1. Their sub-steps are of `fine_motion`, but not where steps
    /// are taken in small ones, which are fine enough.
    double max_entry = 0.02;
    double fine_motion = 0.04;  ///< motion in such a sub-step at most (m), 0.01 to 1
    /// Steps of more motion than this (m, 5e-3 to 1) are searched for solids that the garment went
    /// through on the way, see TunnellingDetector. Their sub-steps are of `tunnelling_motion`, or
    /// of half as much motion as the solid is thick: in these the nearest surface is the one that
    /// the cloth came from.
    double watch_motion = 0.02;
    double tunnelling_motion = 0.01;  ///< (m), 1e-3 to 1
    int max_substeps = 16;            ///< 1 to 64; 1: no step is cut, and none is searched
    IterationLimits iterations = IterationLimits::controlled(5, 50);  ///< of a part, in one step

    /// No step is cut.
    static GuardSettings limbs_alone() {
        GuardSettings settings;
        settings.max_substeps = 1;
        return settings;
    }
    /// Every step is taken as it is.
    static GuardSettings off() {
        GuardSettings settings = limbs_alone();
        settings.limbs = false;
        return settings;
    }
};

struct ClothStepperSettings {
    StepSettings step;
    int substeps = 1;  ///< equal parts of every step at least, 1 to 64: smaller steps damp less and
                       ///< are nearer to the equations of motion. Parts do not use the start, are
                       ///< whole steps of their own, and so dearer than small steps, which are not
                       ///< taken if this is more than 1
    GuardSettings guard;
    double max_ms = std::numeric_limits<double>::infinity();  ///< see ClothStepper::set_max_ms(),
                                                              ///< 0.1 to infinity

    /// Quasi-Newton steps that are taken as they are, for measurements.
    static ClothStepperSettings plain(const IterationLimits& limits = {}) {
        ClothStepperSettings settings;
        settings.step = StepSettings::whole(limits);
        settings.guard = GuardSettings::off();
        return settings;
    }
    /// The converged step, taken as it is: what reports call the reference.
    static ClothStepperSettings reference(const NewtonSettings& newton = {}) {
        ClothStepperSettings settings;
        settings.step.minimiser = MinimiserKind::newton;
        settings.step.newton = newton;
        settings.guard = GuardSettings::off();
        return settings;
    }
};

/// A garment as it should be simulated: steps of a StepSolver where one can be trusted, corrected
/// or cut into parts where not: where obstacles or pins move too fast, where the step failed, and
/// where it went past a surface or through a solid, such as a hand that swings through a hem. A
/// jump of the body by metres (teleport, cut in an animation) is cut into max_substeps parts like
/// any fast motion. Limbs of a body that pass through each other are handled as LimbOverlap says.
///
///     ClothStepper stepper(garment);                    // physics alone
///     stepper.prepare(1.0 / 60.0);                      // optional: nothing is built in a frame
///     StepReport report = stepper.step(boundary, 1.0 / 60.0, state);
///
/// make_cloth() (gnn/model/make_cloth.h) also takes a network.
///
/// ClothState has the mean velocity over a step; the velocity at the end of the last part, or small
/// step, from which the next step goes on, differs from it by a lag. A state whose positions are
/// those that were returned last, or those from which that step began, goes on with its velocity
/// (which others may have changed) and their lag, any other state with its velocity alone.
class ClothStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`.
    /// @param start  of whole steps; null: the projected extrapolation
    /// @throws ArgumentError if a setting is out of range
    explicit ClothStepper(const Garment& garment, const ClothStepperSettings& settings = {},
                          const std::shared_ptr<StepStart>& start = nullptr);
    /// With a solver of its own. @throws ArgumentError also if it is null
    ClothStepper(const Garment& garment, std::unique_ptr<StepSolver> solver,
                 const GuardSettings& guard = {}, int substeps = 1);

    /// The solver's; of steps that are always cut "xN" follows.
    std::string name() const override;
    double fixed_dt() const override { return m_solver->fixed_dt(); }
    /// Steps of other lengths than fixed_dt() are taken as parts of steps are: without a network.
    /// With one for the small steps fixed_dt() is 0: it is asked where a step is a multiple of its
    /// length, and cloth moves.
    bool accepts_any_dt() const override { return true; }
    /// Factorises for steps of this length and for their parts.
    void prepare(double dt) override;
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    void moved(const Points& before, const Points& after, const Eigen::Matrix3d& turn) override;
    /// Before the limit this gives way, in this order: iterations beyond the settings' least, which
    /// in steps of much motion have half of the time only; parts of a step, each of which needs
    /// time for five iterations; the search for what was passed through; small steps, which are
    /// halved in number where there is no time for two iterations each; the other iterations. The
    /// start, one iteration for each part and contact projection take the time that they take.
    /// A step goes beyond the limit where these take longer than they did before, or where it is
    /// the first of its length and prepare() was not called. Newton's method takes no notice
    /// (false).
    bool set_max_ms(double ms) override;
    /// Newton's method takes no notice (false).
    bool set_max_iterations(int most) override;
    bool set_most_residual(double most) override;
    bool start_next_at(const Points& x) override {
        m_solver->start_next_at(x);
        return true;
    }
    bool set_surface_projection(bool on) override {
        m_solver->set_surface_projection(on);
        return true;
    }
    bool is_independent() const override { return m_solver->is_independent(); }
    bool internal_forces(const Points& x, Points& forces) const override;
    std::optional<double> internal_energy(const Points& x) const override {
        return m_solver->internal_energy(x);
    }
    const std::vector<LimbSet>& ignored_limbs() const override { return m_limbs.ignored(); }

    const StepSolver& solver() const { return *m_solver; }
    /// Hierarchies of obstacles, used by parts of steps and where Boundary::trees is null.
    const ObstacleTrees& trees() const { return *m_trees; }

 private:
    ClothStepper(const Garment& garment, const ClothStepperSettings& settings,
                 const std::shared_ptr<StepStart>& start,
                 const std::shared_ptr<ObstacleTrees>& trees);
    ClothStepper(const Garment& garment, std::unique_ptr<StepSolver> solver,
                 const GuardSettings& guard, int substeps, std::shared_ptr<ObstacleTrees> trees);

    struct Lag {
        int parts = 0;
        double dt = 0.0;  ///< of all of them (s)
        Points x;         ///< |V| x 3 (m): what was returned last
        Points v;         ///< |V| x 3 (m/s): velocity at the end of the last part - mean velocity
    };

    enum class Cut { by_motion, again };         ///< the latter's parts are not corrected
    enum class Neighbours { stay, may_follow };  ///< of points that are taken back

    bool is_made_for(double dt) const;
    void add_lag(int parts, double dt, ClothState& state) const;
    void keep_lag(int parts, double dt, const Points& x);
    int affordable(int substeps, int least) const;
    int affordable_small_steps(int count) const;
    StepReport guarded_step(const Boundary& boundary, double dt, ClothState& state);
    void report_ignored(const Points& x, StepReport& report);
    StepReport take_whole(const Boundary& boundary, double dt, double motion, ClothState& state);
    StepReport take_one(const Boundary& boundary, double dt, ClothState& state);
    StepReport take_small_steps(int count, const Boundary& boundary, double dt, ClothState& state);
    StepReport take_parts(int substeps, const Boundary& boundary, double dt, Cut cut,
                          ClothState& state);
    int small_steps_of_part(Cut cut, double dt) const;
    StepReport take_part(const Boundary& part, double dt, const IterationLimits& limits, Cut cut);
    void correct(const Boundary& boundary, double dt, const IterationLimits& limits, bool searched,
                 ClothState& state, StepReport& report);
    void search(const Boundary& boundary, double dt, Neighbours neighbours, ClothState& state,
                StepReport& report);
    void take_back(const Boundary& boundary, double dt, Neighbours neighbours, ClothState& state,
                   StepReport& report);
    bool are_few(int points) const;
    bool went_past(const StepReport& report) const {
        return report.tunnelled || report.max_entry > m_guard.max_entry;
    }
    bool is_watched() const { return m_guard.max_substeps > 1; }
    int substeps_for(double motion, double most) const;
    int substeps_after(const StepReport& report, double dt, double motion) const;

    const Garment* m_garment;
    GuardSettings m_guard;
    int m_substeps;
    std::unique_ptr<StepSolver> m_solver;
    std::shared_ptr<ObstacleTrees> m_trees;
    LimbOverlap m_limbs;
    TunnellingDetector m_detector;
    NeighbourPull m_pull;
    BoundaryPart m_part;
    ClothState m_before;  ///< from which a step is taken again
    ClothState m_state;   ///< during a step of parts
    ClothState m_start;   ///< of a step, or part of one, that may be corrected
    ClothState m_corrected;
    Points m_searched;  ///< |V| x 3 (m)
    /// At the end of the last step, where it began, and at the end of the one that is being taken:
    /// a step may be taken again from where it began.
    Lag m_lag, m_lag_before, m_next_lag;
    double m_max_ms = std::numeric_limits<double>::infinity();
    Deadline m_deadline;          ///< of this step
    double m_part_ms = 0.0;       ///< what a part takes at least, as the last ones did
    double m_iteration_ms = 0.0;  ///< of the last whole step, without its searches
    double m_search_ms = 0.0;     ///< what the last search took
    double m_ignored_ms = 0.0;    ///< what report_ignored() took, after the last step
};

}  // namespace cloth
