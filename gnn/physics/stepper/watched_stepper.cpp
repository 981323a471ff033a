#include "gnn/physics/stepper/watched_stepper.h"

#include <utility>

#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/relative_motion.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {

WatchedStepper::WatchedStepper(const Garment& garment, std::unique_ptr<Stepper> inner,
                               double least_motion)
    : m_garment(&garment),
      m_inner(std::move(inner)),
      m_least_motion(least_motion),
      m_tunnelling(garment) {
    if (!m_inner) throw ArgumentError("stepper", "is null", "give the stepper to be watched");
}

StepReport WatchedStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    const bool watch = is_valid_step(*m_garment, state, boundary, dt) &&
                       relative_motion(*m_garment, boundary, dt, state) > m_least_motion;
    if (watch) m_before = state.x;
    StepReport report = m_inner->step(boundary, dt, state);
    if (!watch || !report.finite) return report;
    Stopwatch watch_time;
    m_tunnelling.find(boundary, m_before, state.x, 0);
    report.tunnelled = m_tunnelling.thinnest();
    report.times.contact += watch_time.lap();
    return report;
}

}  // namespace cloth
