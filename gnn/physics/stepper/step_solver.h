#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "collision/ccd/tunnelling.h"
#include "collision/proximity/ridge_contacts.h"
#include "collision/response/contact_projection.h"
#include "collision/response/goal_projection.h"
#include "gnn/physics/energy/time_integration.h"
#include "gnn/physics/solver/newton.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/boundary_part.h"
#include "gnn/physics/stepper/contact_part.h"
#include "gnn/physics/stepper/self_contact_projection.h"
#include "gnn/physics/stepper/step_start.h"

namespace cloth {

/// quasi_newton: what simulations use. newton: converged, the reference of reports.
enum class MinimiserKind { quasi_newton, newton };

struct StepSettings {
    MinimiserKind minimiser = MinimiserKind::quasi_newton;
    QuasiNewtonSettings quasi_newton = few(3);  ///< in a whole step, or in each small one
    NewtonSettings newton;
    PotentialSettings potential;
    ProximitySettings proximity;
    /// How often the nearest surface points are found anew for the minimum and the minimisation
    /// goes on with them, 0 to 10. 0 keeps those that were nearest at t; more follow cloth that
    /// slides past the end of a face.
    int contact_updates = 0;
    /// Small steps are parts of equal length in which a step is minimised, one after the other, as
    /// many as make this rate at least (1/s, 0 to 10000), but 64 at most; 0: none. Each has the
    /// iterations of `quasi_newton`. All have the contacts of the step, which move along, and one
    /// contact projection follows the last. Small steps damp less, are nearer to the equations of
    /// motion, and need fewer iterations; above this rate no step is cut. Cloth that hardly moves
    /// takes one step instead, with the iterations of all, ten at least, and more for as long as
    /// they gain, so that it comes to rest where it should, and so does a step that has to reach a
    /// residual. By Newton's method it takes four iterations at most, for as long as they gain 0.1
    /// mm. A start that is made for steps of their length is asked in each; what one for the whole
    /// step predicts is shared out between them.
    double small_step_rate = 120.0;
    /// Small steps of stiff cloth without a start are each one Newton step of so many
    /// conjugate-gradient iterations, 0 to 200, whatever `quasi_newton` says: few iterations of
    /// that hold stiff cloth back where it could bend. Two of `quasi_newton` follow in garments
    /// with goals. Parts of steps that are cut have many, which are not Newton's. 0: they are like
    /// those of soft cloth. Stiff is cloth in which waves along it, of the speed sqrt((2 mu +
    /// lambda) / density), are faster than 32 m/s.
    int stiff_cg_iterations = 10;
    /// Vertices that end closer than this to an obstacle (m), because they left the plane of their
    /// contact, are moved to this distance, 0 to 1e-3.
    double safety_distance = 5e-4;

    /// Few iterations in each small step: as near to the equations of motion as many in one whole
    /// step, in less time, and in nearly the same time in every step. The default of soft cloth.
    static StepSettings in_small_steps(double rate = 120.0, int iterations = 3) {
        StepSettings settings;
        settings.stiff_cg_iterations = 0;
        settings.small_step_rate = rate;
        settings.quasi_newton = few(iterations);
        return settings;
    }
    /// One Newton step in each small step, found by so many conjugate-gradient iterations. The
    /// default of stiff cloth, such as real cotton.
    static StepSettings newton_in_small_steps(double rate = 120.0, int cg_iterations = 10) {
        StepSettings settings = in_small_steps(rate, 1);
        settings.quasi_newton.hessian_cg_iterations = cg_iterations;
        return settings;
    }
    /// One minimisation for each step.
    static StepSettings whole(const QuasiNewtonSettings& limits = IterationLimits::controlled()) {
        StepSettings settings;
        settings.small_step_rate = 0.0;
        settings.quasi_newton = limits;
        return settings;
    }

 private:
    static QuasiNewtonSettings few(int iterations) {
        QuasiNewtonSettings settings = IterationLimits::exactly(iterations);
        settings.contact_cg_iterations = 5;
        return settings;
    }
};

/// One implicit step of a garment: nearest surface points, incremental potential, a start
/// (projected extrapolation or network), a minimiser, and projections, which leave nothing inside
/// an obstacle and nothing beyond the limits of skinned goals. ClothStepper makes simulations of
/// it.
///
/// From a start that is not finite, or of higher energy than the guess, the step starts at the
/// guess; from a guess of which the energy is not finite, at x_t. Without iterations
/// (IterationLimits::none()) a finite start is taken as it is.
///
/// Takes any time step; what depends on it is kept for the last ones. Serves one thread at a time.
class StepSolver {
 public:
    /// Keeps a reference to `garment`.
    /// @param start  of whole steps; null: the guess
    /// @param trees  of the obstacles where Boundary::trees is null; null: its own
    /// @throws ArgumentError if a setting is out of range
    StepSolver(const Garment& garment, const StepSettings& settings,
               std::shared_ptr<StepStart> start = nullptr,
               std::shared_ptr<ObstacleTrees> trees = nullptr);
    virtual ~StepSolver() = default;

    /// "quasi-newton-K" with exactly K iterations, "quasi-newton" with as many as it takes, with
    /// "sR" for R small steps a second, "-cgK" with K iterations of conjugate gradients with the
    /// Hessian in each, and with "-bdf2" at the end if that integrates; "reference"
    /// of Newton's method; with a start its name, and "+K" with exactly K iterations, "+1e-02" with
    /// a tolerance, "+KsR" with small steps.
    std::string name() const;
    /// The start's; 0 without one, and where it is one for the small steps.
    double fixed_dt() const;
    const StepSettings& settings() const { return m_settings; }
    /// See Stepper::is_independent(): if the start is, and nobody else holds it.
    bool is_independent() const {
        return !m_start || (m_start.use_count() == 1 && m_start->is_independent());
    }

    /// Builds what steps of this length (s) need. Never throws.
    void prepare(double dt);
    /// When steps have to be done. The start, one iteration and contact are always computed, and
    /// Newton's method takes no notice.
    /// @param for_more  of iterations beyond IterationLimits::least()
    void set_deadline(const Deadline& deadline, const Deadline& for_more) {
        m_deadline = deadline;
        m_deadline_for_more = for_more;
    }
    void set_deadline(const Deadline& deadline) { set_deadline(deadline, deadline); }
    /// Of quasi-Newton, where limits ask for more, 1 or more; a small step takes one at least.
    void set_max_iterations(int most) { m_max_iterations = std::max(1, most); }
    /// See Stepper::set_surface_projection().
    void set_surface_projection(bool on) { m_projection.set_surface(on); }
    /// What knows where face centres and edge midpoints went in, so that they come out there; null:
    /// they come out where they are nearest to the surface.
    void set_ways_in(const TunnellingDetector* ways) { m_ways_in = ways; }
    /// See Stepper::set_most_residual(); of quasi-Newton.
    void set_most_residual(double most) { m_most_residual = most; }
    /// See Stepper::start_next_at(); of the next step in one part. Without rows: as always.
    void start_next_at(const Points& x) { m_next_start = x; }
    int factorisations() const { return m_quasi_newton.matrix().factorisations(); }  ///< so far

    /// A whole step, from the start if there is one for this length. Where settings ask for small
    /// steps it has as many iterations as StepSettings::small_step_rate says of cloth that hardly
    /// moves. The arguments have passed is_valid_step(); a step that fails leaves the state as it
    /// was.
    virtual StepReport whole(const Boundary& boundary, double dt, ClothState& state);

    /// Moves `x` (|V| x 3, m), where something else says that the step ends, such as a coarser
    /// garment, on towards the minimum: out of the obstacles, and from the start's prediction if
    /// there is one for steps of this length. Neither contact projection nor untangling follows.
    /// False: it failed, and x is as it was.
    /// @param contacts  whether surface points are those nearest to the state, as in other steps,
    /// or
    ///                  at the end to x: where something moved too far for the former to hold
    bool go_on_from(Points& x, StepEnd contacts, const Boundary& boundary, double dt,
                    const ClothState& state, StepReport& report);
    /// Ends the step of go_on_from() where contact projection has put it (|V| x 3, m).
    void end_at(const Points& x, ClothState& state) const {
        m_potential.friction().remember(x, state.stick);
    }

    enum class From { start, guess };
    /// The same in so many small steps, from the start or without it. The state has the mean
    /// velocity of the step afterwards; the next one should go on from end_velocity().
    virtual StepReport in_small_steps(int count, const Boundary& boundary, double dt, From from,
                                      ClothState& state);
    /// In how many a step of this length (s) is taken if the cloth moves.
    int small_steps(double dt) const;
    /// The same from this state; 1: it is whole.
    int small_steps(double dt, const ClothState& state) const;
    /// Iterations that a small step should have time for: better few steps than bad ones.
    int worthwhile_iterations() const;
    /// Of the last step, at its end (|V| x 3, m/s).
    const Points& end_velocity() const { return m_v; }

    /// In how many (from From::start) a part of this length (s) is as good as in part(), where a
    /// step was cut because of its motion; 0: in none.
    int small_steps_of_part(double dt, const ClothState& state) const;
    /// A part of a step that was cut, from the guess. Newton's method keeps its own limits.
    virtual StepReport part(const Boundary& boundary, double dt, const IterationLimits& limits,
                            ClothState& state);

    /// Takes the last step once more, on from where it ended: with the surface points that are
    /// nearest to there, and where `through` is not null, what it found held where it went in.
    /// @param state  as it was before the step
    virtual StepReport correct(const Boundary& boundary, double dt,
                               const TunnellingDetector* through, const IterationLimits& limits,
                               ClothState& state);

    /// See Stepper::internal_forces(). Where x is the end of the last step, and that was taken in
    /// small steps, the mean of those at their ends: what the step's change of momentum has of
    /// them.
    void internal_forces(const Points& x, Points& forces) const;

    double internal_energy(const Points& x) const { return m_potential.internal_energy(x); }

    /// Where the last whole step started (|V| x 3, m): the prediction, if there was one.
    const Points& start() const { return m_started; }
    Proximity& proximity() { return m_proximity; }  ///< what nearest points are asked from
    const SelfContactProjection& self_contact() const { return m_self_contact; }  ///< last step's

 private:
    StepStart* start_for(double dt) const;
    IterationLimits adjusted(IterationLimits limits) const;
    IterationLimits enough(const IterationLimits& limits) const;
    IterationLimits for_correction(const IterationLimits& limits, double dt) const;
    enum class Start { guess, here, outside };  ///< here: m_x; outside: m_x, out of obstacles
    StepReport solve(const Boundary& boundary, double dt, StepStart* start,
                     const IterationLimits& limits, int parts, ClothState& state);
    void find_contacts(const Boundary& boundary, const Points& x, StepEnd end);
    bool run(const Boundary& boundary, double dt, StepStart* start, Start from,
             const IterationLimits& limits, int parts, const ClothState& state, StepReport& report);
    bool run_small_steps(const Boundary& boundary, double dt, StepStart* start,
                         const IterationLimits& limits, const std::vector<char>& unrepelled,
                         StepReport& report);
    bool predict_acceleration(const Boundary& boundary, double dt, StepStart& start,
                              const std::vector<char>& unrepelled, StepReport& report);
    const PotentialValue* start_from_acceleration(const Boundary& boundary,
                                                  const SurfaceContacts& contacts,
                                                  StepReport& report);
    void share(const Deadline& whole, int parts, Deadline& part) const;
    void begin(const Boundary& boundary, const SurfaceContacts& contacts, double dt,
               const std::vector<char>& unrepelled);
    bool minimise_part(const Boundary& boundary, const SurfaceContacts& contacts, StepStart* start,
                       Start from, const IterationLimits& limits, StepReport& report);
    bool undo_gain(const Boundary& boundary, const SurfaceContacts& contacts,
                   const IterationLimits& limits, StepReport& report);
    double lowest_towards_end(double at_stop);
    void accept_part();
    const PotentialValue* choose_start(const Boundary& boundary, const SurfaceContacts& contacts,
                                       StepStart* start, const IterationLimits& limits, double dt,
                                       const ClothState& state, StepReport& report);
    void let_fall(const Boundary& boundary, const SurfaceContacts& contacts);
    bool is_clear_of(const SurfaceContacts& contacts, double farther) const;
    const PotentialValue* start_as_told(const Boundary& boundary);
    const PotentialValue* start_outside(const Boundary& boundary, const SurfaceContacts& contacts,
                                        StepStart* start, const IterationLimits& limits,
                                        StepReport& report);
    const PotentialValue* ask(StepStart& start, const Boundary& boundary,
                              const IterationLimits& limits, const ClothState& state,
                              StepReport& report);
    const PotentialValue* lower_of_guess_and_prediction(bool guess_known, StepReport& report);
    MinimiseReport minimise(const IterationLimits& limits, const PotentialValue* at_x);
    bool iterates_after_newton() const;
    void iterate_after_newton(MinimiseReport& minimum);
    bool descend(const Boundary& boundary, const IterationLimits& limits,
                 const PotentialValue* at_x, const ClothState& state, StepReport& report);
    ContactProjection::WayIn way_in(const Boundary& boundary, const Points& before) const;
    void project(const Boundary& boundary, const ClothState& state, StepReport& report);
    StepReport finish(const Boundary& boundary, double dt, ClothState& state, StepReport report);
    bool accept(double dt, ClothState& state);
    void end_velocities(double dt, const ClothState& state);

    const Garment* m_garment;
    StepSettings m_settings;
    std::shared_ptr<StepStart> m_start;
    IncrementalPotential m_potential;
    TimeIntegration m_time;
    QuasiNewton m_quasi_newton;
    Newton m_newton;
    Proximity m_proximity;
    RidgeFinder m_ridges;
    ContactProjection m_projection;
    const TunnellingDetector* m_ways_in = nullptr;
    GoalProjection m_goals;
    SelfContactProjection m_self_contact;
    SurfaceContacts m_contacts;
    Deadline m_deadline, m_deadline_for_more;
    int m_max_iterations = std::numeric_limits<int>::max();
    double m_most_residual = std::numeric_limits<double>::infinity();
    double m_contact_ms = 0.0;  ///< what contact took in the last step
    PotentialValue m_at_guess, m_at_prediction;
    Points m_guess, m_started;  ///< |V| x 3 (m)
    Points m_stop, m_between;   ///< |V| x 3 (m)
    Points m_next_start;        ///< |V| x 3 (m), or without rows, see start_next_at()
    double m_energy = 0.0;      ///< of m_x after the last minimisation (J)
    Points m_acceleration;      ///< |V| x 3 (m/s^2): what the start adds to guesses
    Points m_x, m_v;            ///< |V| x 3: the new positions and velocities
    BoundaryPart m_boundary_part;
    ContactPart m_contact_part;
    ClothState m_last;                ///< from which the last part began
    double m_last_dt = 0.0;           ///< its length (s)
    int m_parts = 1;                  ///< of the last step
    std::vector<Points> m_part_ends;  ///< (parts - 1) x |V| x 3 (m): of all but the last
};

}  // namespace cloth
