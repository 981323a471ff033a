#include "gnn/physics/guarded_stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "collision/check_range.h"
#include "data/errors.h"
#include "gnn/physics/guess.h"
#include "gnn/physics/quasi_newton_stepper.h"

namespace cloth {
namespace {

constexpr double reach = 0.05;  // surfaces this near the garment's box count (m)

using Box = Eigen::AlignedBox3d;

Box box_of(const Points& x) {
    return Box(Vec3(x.colwise().minCoeff()), Vec3(x.colwise().maxCoeff()));
}

/// The garment and where its mean motion takes it, with some reach.
Box swept_box(const ClothState& state, const Vec3& shift) {
    Box box = box_of(state.x);
    box.extend(Box(box).translate(shift));
    return Box(box.min() - Vec3::Constant(reach), box.max() + Vec3::Constant(reach));
}

double mesh_motion(const Obstacle& mesh, const Box& box, const Vec3& shift) {
    if (mesh.x0.rows() != mesh.x1.rows()) return 0.0;
    double farthest = 0.0;
    for (Eigen::Index i = 0; i < mesh.x0.rows(); ++i) {
        const Vec3 from = mesh.x0.row(i), to = mesh.x1.row(i);
        const double motion = (to - from - shift).squaredNorm();
        if (motion <= farthest) continue;
        Box path(from.cwiseMin(to), from.cwiseMax(to));
        if (box.intersects(path)) farthest = motion;
    }
    return std::sqrt(farthest);
}

/// Of a sphere around a primitive that holds it; a plane does not turn noticeably where cloth is.
double primitive_motion(const Obstacle& shape, const Box& box, const Vec3& shift) {
    const double size = shape.radius + shape.half_extents.norm();
    const Vec3 from = shape.pose0.translation(), to = shape.pose1.translation();
    const Box path(from.cwiseMin(to) - Vec3::Constant(size),
                   from.cwiseMax(to) + Vec3::Constant(size));
    if (shape.shape != ObstacleShape::plane && !box.intersects(path)) return 0.0;
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(shape.pose0.linear().transpose() * shape.pose1.linear()));
    return (to - from - shift).norm() + std::abs(turn.angle()) * size;
}

void check(const GuardSettings& settings) {
    check_range("GuardSettings.max_motion", settings.max_motion, 0.01, 1.0);
    check_range("GuardSettings.max_entry", settings.max_entry, 1e-3, 0.1);
    check_range("GuardSettings.fine_motion", settings.fine_motion, 0.01, 1.0);
    check_range("GuardSettings.max_substeps", settings.max_substeps, 1, 64);
}

}  // namespace

double relative_motion(const Garment& garment, const Boundary& boundary, double dt,
                       const ClothState& state) {
    if (state.x.rows() == 0) return 0.0;
    const Vec3 shift = dt * state.v.colwise().mean().transpose();
    const Box box = swept_box(state, shift);
    double farthest = 0.0;
    for (size_t p = 0; p < garment.pins().size(); ++p) {
        const Vec3 motion =
            boundary.pin_targets.row(static_cast<Eigen::Index>(p)) - state.x.row(garment.pins()[p]);
        farthest = std::max(farthest, (motion - shift).norm());
    }
    for (const Obstacle& obstacle : boundary.obstacles)
        farthest = std::max(farthest, obstacle.shape == ObstacleShape::mesh
                                          ? mesh_motion(obstacle, box, shift)
                                          : primitive_motion(obstacle, box, shift));
    return farthest;
}

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
    return guarded_step(m_limbs.filter(boundary, dt, state), dt, state);
}

StepReport GuardedStepper::guarded_step(const Boundary& boundary, double dt, ClothState& state) {
    const double motion = relative_motion(*m_garment, boundary, dt, state);
    const int foreseen = substeps_for(motion, m_settings.max_motion);
    if (foreseen > 1) return cut_step(foreseen, boundary, dt, state);
    const int fine = substeps_for(motion, m_settings.fine_motion);
    if (fine > 1) m_before = state;
    const StepReport report = m_inner->step(boundary, dt, state);
    if (m_settings.max_substeps == 1) return report;
    if (!report.finite) return cut_step(2, boundary, dt, state);
    if (fine == 1 || !(report.max_entry > m_settings.max_entry)) return report;
    const StepReport finer = cut_step(fine, boundary, dt, m_before);
    if (!finer.finite) {  // better the first step than none
        m_last_substeps = 1;
        --m_guarded_steps;
        return report;
    }
    std::swap(state, m_before);
    return finer;
}

StepReport GuardedStepper::cut_step(int substeps, const Boundary& boundary, double dt,
                                    ClothState& state) {
    m_last_substeps = substeps;
    ++m_guarded_steps;
    return fallback(substeps).step(boundary, dt, state);
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
            *m_garment, std::make_unique<QuasiNewtonStepper>(*m_garment, m_settings.solver),
            substeps);
    return *made;
}

}  // namespace cloth
