#include "gnn/physics/stepper/substepped_stepper.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {

namespace {

Pose between(const Pose& a, const Pose& b, double s) {
    Pose pose = Pose::Identity();
    pose.translation() = (1.0 - s) * a.translation() + s * b.translation();
    pose.linear() =
        Eigen::Quaterniond(a.linear()).slerp(s, Eigen::Quaterniond(b.linear())).toRotationMatrix();
    return pose;
}

/// The part [s0, s1] of an obstacle's motion. The end of the last part is the obstacle's, bit for
/// bit, and parts join.
void cut(const Obstacle& whole, double s0, double s1, Obstacle& part) {
    const auto vertices = [&](double s, Points& x) {
        if (s <= 0.0)
            x = whole.x0;
        else if (s >= 1.0)
            x = whole.x1;
        else
            x = (1.0 - s) * whole.x0 + s * whole.x1;
    };
    part.shape = whole.shape;
    part.faces = whole.faces;
    part.limbs = whole.limbs;
    part.half_extents = whole.half_extents;
    part.radius = whole.radius;
    part.friction = whole.friction;
    if (whole.shape == ObstacleShape::mesh && whole.x0.rows() == whole.x1.rows()) {
        vertices(s0, part.x0);
        vertices(s1, part.x1);
    }
    part.pose0 = s0 <= 0.0 ? whole.pose0 : between(whole.pose0, whole.pose1, s0);
    part.pose1 = s1 >= 1.0 ? whole.pose1 : between(whole.pose0, whole.pose1, s1);
}

void add(const StepReport& part, StepReport& report) {
    report.iterations += part.iterations;
    report.residual = part.residual;
    report.gain = part.gain;
    report.converged = part.converged && report.converged;
    report.max_penetration = part.max_penetration;
    report.max_entry = std::max(report.max_entry, part.max_entry);
    report.tunnelled = std::min(report.tunnelled, part.tunnelled);
    report.tangles = part.tangles;
    report.first_tangle = part.first_tangle;
    report.times.proximity += part.times.proximity;
    report.times.features += part.times.features;
    report.times.solve += part.times.solve;
    report.times.contact += part.times.contact;
}

}  // namespace

SubsteppedStepper::SubsteppedStepper(const Garment& garment, std::unique_ptr<Stepper> stepper,
                                     int substeps)
    : m_garment(&garment), m_stepper(std::move(stepper)), m_substeps(substeps) {
    if (!m_stepper) throw ArgumentError("stepper", "is null", "give the stepper to be cut");
    if (m_stepper->fixed_dt() > 0.0)
        throw ArgumentError("stepper " + m_stepper->name(), "has a time step of its own",
                            "cut steppers that take any time step");
    if (substeps < 1 || substeps > 64)
        throw ArgumentError("substeps", std::to_string(substeps) + " is outside 1 to 64", "use 4");
}

std::string SubsteppedStepper::name() const {
    return m_stepper->name() + "x" + std::to_string(m_substeps);
}

void SubsteppedStepper::place(const Boundary& boundary, int substep) {
    const double s0 = static_cast<double>(substep) / m_substeps;
    const double s1 = static_cast<double>(substep + 1) / m_substeps;
    for (size_t k = 0; k < boundary.obstacles.size(); ++k)
        cut(boundary.obstacles[k], s0, s1, m_part.obstacles[k]);
    m_part.pin_targets = substep + 1 == m_substeps
                             ? boundary.pin_targets
                             : Points((1.0 - s1) * m_pins_before + s1 * boundary.pin_targets);
}

StepReport SubsteppedStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    StepReport report;
    if (!is_valid_step(*m_garment, state, boundary, dt)) {
        report.finite = false;
        report.residual = std::numeric_limits<double>::quiet_NaN();
        return report;
    }
    report.converged = true;
    m_state = state;
    if (m_last_x.rows() == state.x.rows() && m_last_x == state.x) m_state.v += m_lag;
    m_part.gravity = boundary.gravity;
    m_part.accelerations = boundary.accelerations;
    m_part.ignored_limbs = boundary.ignored_limbs;
    m_part.obstacles.resize(boundary.obstacles.size());
    m_pins_before.resize(boundary.pin_targets.rows(), 3);
    for (size_t p = 0; p < m_garment->pins().size(); ++p)
        m_pins_before.row(static_cast<Eigen::Index>(p)) = state.x.row(m_garment->pins()[p]);
    for (int substep = 0; substep < m_substeps; ++substep) {
        place(boundary, substep);
        const StepReport part = m_stepper->step(m_part, dt / m_substeps, m_state);
        add(part, report);
        report.finite = part.finite;
        if (!report.finite) return report;
    }
    m_state.time = state.time + dt;
    m_last_x = m_state.x;
    m_lag = m_state.v;
    m_state.v = (m_state.x - state.x) / dt;
    m_lag -= m_state.v;
    std::swap(state, m_state);
    return report;
}

}  // namespace cloth
