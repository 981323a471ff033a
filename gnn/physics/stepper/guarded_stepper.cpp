#include "gnn/physics/stepper/guarded_stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/quasi_newton_stepper.h"
#include "gnn/physics/stepper/watched_stepper.h"

namespace cloth {
namespace {

void check(const GuardSettings& settings) {
    check_range("GuardSettings.max_motion", settings.max_motion, 0.01, 1.0);
    check_range("GuardSettings.max_entry", settings.max_entry, 1e-3, 0.1);
    check_range("GuardSettings.fine_motion", settings.fine_motion, 0.01, 1.0);
    check_range("GuardSettings.watch_motion", settings.watch_motion, 5e-3, 1.0);
    check_range("GuardSettings.tunnelling_motion", settings.tunnelling_motion, 1e-3, 1.0);
    check_range("GuardSettings.max_substeps", settings.max_substeps, 1, 64);
}

std::unique_ptr<Stepper> watched(const Garment& garment, std::unique_ptr<Stepper> stepper,
                                 const GuardSettings& settings) {
    if (settings.max_substeps == 1) return stepper;  // nothing could be done about it
    return std::make_unique<WatchedStepper>(garment, std::move(stepper), settings.watch_motion);
}

}  // namespace

std::unique_ptr<Stepper> make_physics_cloth(const Garment& garment,
                                            const QuasiNewtonSettings& settings,
                                            const GuardSettings& guard) {
    auto stepper = std::make_unique<QuasiNewtonStepper>(garment, settings);
    GuardSettings same_physics = guard;
    same_physics.solver.potential = settings.potential;
    return std::make_unique<GuardedStepper>(garment, std::move(stepper), same_physics);
}

GuardedStepper::GuardedStepper(const Garment& garment, std::unique_ptr<Stepper> inner,
                               GuardSettings settings)
    : m_garment(&garment), m_inner(std::move(inner)), m_settings(std::move(settings)) {
    if (!m_inner) throw ArgumentError("stepper", "is null", "give the stepper to be guarded");
    check(m_settings);
    m_inner = watched(garment, std::move(m_inner), m_settings);
    QuasiNewtonStepper(garment, m_settings.solver);  // refuses its settings here, not in a step
}

StepReport GuardedStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    m_last_substeps = 1;
    if (!is_valid_step(*m_garment, state, boundary, dt)) {
        StepReport report;
        report.finite = false;
        report.residual = std::numeric_limits<double>::quiet_NaN();
        return report;
    }
    StepReport report = guarded_step(m_limbs.filter(boundary, dt, state), dt, state);
    if (report.finite) report_ignored(state.x, report);
    return report;
}

/// What contact leaves alone is no penetration, but nobody should take it for air either.
void GuardedStepper::report_ignored(const Points& x, StepReport& report) {
    const IgnoredDepth ignored = m_limbs.measure_ignored(x, m_garment->is_pinned());
    report.vertices_in_ignored_limbs = ignored.vertices;
    report.max_ignored_depth = ignored.depth;
}

/// A step that turns out to be too coarse is taken once more, as finely as its report asks for.
StepReport GuardedStepper::guarded_step(const Boundary& boundary, double dt, ClothState& state) {
    const double motion = relative_motion(*m_garment, boundary, dt, state);
    const int foreseen = substeps_for(motion, m_settings.max_motion);
    const bool may_repeat = foreseen < m_settings.max_substeps;
    if (may_repeat) m_before = state;
    const StepReport report = take(foreseen, boundary, dt, state);
    const int finer = may_repeat ? substeps_after(report, motion) : foreseen;
    if (finer > foreseen) {
        const StepReport repeated = take(finer, boundary, dt, m_before);
        if (repeated.finite || !report.finite) {
            if (repeated.finite) std::swap(state, m_before);
            count(finer);
            return repeated;
        }
    }  // better the first step than none
    count(foreseen);
    return report;
}

void GuardedStepper::count(int substeps) {
    m_last_substeps = substeps;
    m_guarded_steps += substeps > 1;
}

StepReport GuardedStepper::take(int substeps, const Boundary& boundary, double dt,
                                ClothState& state) {
    if (substeps == 1) return m_inner->step(boundary, dt, state);
    return fallback(substeps).step(boundary, dt, state);
}

/// How finely a step of this motion should have been taken.
int GuardedStepper::substeps_after(const StepReport& report, double motion) const {
    int substeps = report.finite ? 1 : 2;
    if (report.max_entry > m_settings.max_entry)
        substeps = std::max(substeps, substeps_for(motion, m_settings.fine_motion));
    if (std::isfinite(report.tunnelled))
        substeps = std::max(substeps, substeps_for(motion, std::min(m_settings.tunnelling_motion,
                                                                    0.5 * report.tunnelled)));
    return substeps;
}

/// Powers of two, so that few matrices are factorised.
int GuardedStepper::substeps_for(double motion, double most) const {
    int substeps = 1;
    while (substeps * most < motion && substeps < m_settings.max_substeps) substeps *= 2;
    return std::min(substeps, m_settings.max_substeps);
}

Stepper& GuardedStepper::fallback(int substeps) {
    std::unique_ptr<SubsteppedStepper>& made = m_fallbacks[substeps];
    if (!made)
        made = std::make_unique<SubsteppedStepper>(
            *m_garment,
            watched(*m_garment, std::make_unique<QuasiNewtonStepper>(*m_garment, m_settings.solver),
                    m_settings),
            substeps);
    return *made;
}

}  // namespace cloth
