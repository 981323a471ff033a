#include "gnn/physics/stepper/divided_stepper.h"

#include <algorithm>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/part_report.h"

namespace cloth {

DividedStepper::DividedStepper(const Garment& garment, std::unique_ptr<Stepper> inner, int parts)
    : m_garment(&garment), m_inner(std::move(inner)), m_parts(parts) {
    if (!m_inner)
        throw ArgumentError("DividedStepper of " + garment.name(), "there is no stepper",
                            "give the one that takes the parts");
    check_range("DividedStepper.parts", parts, 1, 64);
}

std::string DividedStepper::name() const {
    return m_inner->name() + "x" + std::to_string(m_parts);
}

StepReport DividedStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_garment, state, boundary, dt)) return StepReport::failed();
    m_state = state;
    const bool goes_on = same_points(m_lag.x, state.x);
    if (goes_on)
        m_state.v += m_lag.v;
    else if (same_points(m_lag_before.x, state.x))
        m_state.v += m_lag_before.v;
    m_part.begin(*m_garment, state, boundary, m_parts);
    m_next_ends.resize(static_cast<size_t>(m_parts) - 1);
    StepReport report;
    report.converged = true;
    for (int k = 0; k < m_parts; ++k) {
        if (k > 0) m_next_ends[static_cast<size_t>(k) - 1] = m_state.x;
        const StepReport part = m_inner->step(m_part.take(k), dt / m_parts, m_state);
        add_part(part, report);
        report.substeps = std::max(report.substeps, part.substeps);
        if (!report.finite) return report;
    }
    std::swap(m_part_ends, m_next_ends);
    if (goes_on) std::swap(m_lag_before, m_lag);
    m_lag.x = m_state.x;
    m_lag.v = m_state.v;
    m_state.v = (m_state.x - state.x) / dt;
    m_lag.v -= m_state.v;
    m_state.time = state.time + dt;
    std::swap(state, m_state);
    return report;
}

void DividedStepper::moved(const Points& before, const Points& after, const Eigen::Matrix3d& turn) {
    m_inner->moved(before, after, turn);
    for (Lag* lag : {&m_lag, &m_lag_before}) {
        if (!same_points(lag->x, before)) continue;
        lag->x = after;
        lag->v *= turn.transpose();
    }
}

bool DividedStepper::internal_forces(const Points& x, Points& forces) const {
    if (!m_inner->internal_forces(x, forces)) return false;
    if (!same_points(m_lag.x, x)) return true;
    Points part;
    for (const Points& end : m_part_ends) {
        m_inner->internal_forces(end, part);
        forces += part;
    }
    forces /= m_parts;
    return true;
}

}  // namespace cloth
