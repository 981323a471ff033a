#include "gnn/physics/energy/friction.h"

#include <algorithm>
#include <cmath>

#include "collision/proximity/direction.h"

namespace cloth {

namespace {

Vec3 mean_normal(const Vec3& normal0, const Vec3& normal1) {
    const Vec3 sum = normal0 + normal1;
    const double length = sum.norm();
    return length > 1e-6 ? Vec3(sum / length) : normal1;
}

/// The two estimates of FrictionEnergy's comment (N).
/// @param depth   how far the vertex is inside the contact distance at t (m)
double normal_force(double mass, const Vec3& gravity, const Vec3& normal, double depth,
                    const FrictionSettings& settings) {
    const double carried = mass * std::max(0.0, -normal.dot(gravity));
    const double limit = settings.pressure_limit * mass * limiting_acceleration(gravity);
    const double pressed = 3.0 * settings.contact_weight * std::pow(std::max(0.0, depth), 2);
    return std::max(carried, std::min(pressed, limit));
}

Vec3 tangential(const Vec3& v, const Vec3& normal) {
    return v - normal.dot(v) * normal;
}

/// Slip (m), in units of s, that lasts: it carries 0.95 of the largest friction.
constexpr double kept_slip = 3.0;

/// What the last step left (m), as far as it stores no more energy than it did then.
/// @param force  mu N (N)
Vec3 slip_at_start(const StickMemory& memory, Eigen::Index vertex, const Vec3& normal, double force,
                   double smooth_slip) {
    if (vertex >= memory.slip.rows() || vertex >= memory.energy.size()) return Vec3::Zero();
    const Vec3 slip = tangential(memory.slip.row(vertex), normal);
    const double length = slip.norm(), stored = memory.energy[vertex] / force;
    if (!(std::isfinite(length) && length > 0.0 && stored > 0.0)) return Vec3::Zero();
    const double passive = std::sqrt(stored * (stored + 2.0 * smooth_slip));
    return std::min({1.0, kept_slip * smooth_slip / length, passive / length}) * slip;
}

}  // namespace

void FrictionEnergy::begin_step(const Garment& garment, const ClothState& state,
                                const Boundary& boundary, const SurfaceContacts& contacts,
                                const FrictionSettings& settings) {
    m_sliders.clear();
    m_slip = settings.slip;
    const Eigen::Index count = static_cast<Eigen::Index>(contacts.obstacle.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        if (!contacts.has(i) || !(contacts.distance[i] < settings.distance)) continue;
        const size_t obstacle = static_cast<size_t>(contacts.obstacle[static_cast<size_t>(i)]);
        const double mu = settings.scale * boundary.obstacles[obstacle].friction;
        const Vec3 normal = mean_normal(contacts.normal0.row(i), contacts.normal1.row(i));
        const double depth = settings.contact_distance - contacts.distance[i];
        const double mass = garment.masses()[i];
        const double pinch = is_pinched(boundary, i)
                                 ? settings.pinch_pressure * mass / garment.fabric().density
                                 : 0.0;
        const double force =
            mu * std::max(pinch, normal_force(mass, boundary.gravity, normal, depth, settings));
        if (!(force > 0.0)) continue;
        const Vec3 carried = carried_motion(contacts, i, state.x);
        const Vec3 slip = slip_at_start(state.stick, i, normal, force, m_slip);
        m_sliders.push_back({i, normal, state.x.row(i).transpose() + carried - slip, force});
    }
}

void FrictionEnergy::remember(const Points& x, StickMemory& memory) const {
    memory.slip.setZero(m_sliders.empty() ? 0 : x.rows(), 3);
    memory.energy.setZero(memory.slip.rows());
    for (const Slider& slider : m_sliders) {
        const Vec3 slip =
            tangential(x.row(slider.vertex).transpose() - slider.stick, slider.normal);
        memory.slip.row(slider.vertex) = slip;
        memory.energy[slider.vertex] =
            slider.force * (std::sqrt(m_slip * m_slip + slip.squaredNorm()) - m_slip);
    }
}

double FrictionEnergy::value(const Points& x) const {
    double energy = 0.0;
    for (const Slider& slider : m_sliders) {
        const Vec3 slip =
            tangential(x.row(slider.vertex).transpose() - slider.stick, slider.normal);
        energy += slider.force * (std::sqrt(m_slip * m_slip + slip.squaredNorm()) - m_slip);
    }
    return energy;
}

double FrictionEnergy::add_gradient(const Points& x, Points& gradient) const {
    double energy = 0.0;
    for (const Slider& slider : m_sliders) {
        const Vec3 slip =
            tangential(x.row(slider.vertex).transpose() - slider.stick, slider.normal);
        const double smooth = std::sqrt(m_slip * m_slip + slip.squaredNorm());
        gradient.row(slider.vertex) += (slider.force / smooth) * slip.transpose();
        energy += slider.force * (smooth - m_slip);
    }
    return energy;
}

void FrictionEnergy::add_hessian(const Points& x, const BlockPattern& pattern,
                                 double* values) const {
    for (const Slider& slider : m_sliders) {
        const Vec3 slip =
            tangential(x.row(slider.vertex).transpose() - slider.stick, slider.normal);
        const double smooth = std::sqrt(m_slip * m_slip + slip.squaredNorm());
        const Eigen::Matrix3d tangent =
            Eigen::Matrix3d::Identity() - slider.normal * slider.normal.transpose();
        add_block(values, pattern.diagonal(slider.vertex),
                  slider.force / smooth * (tangent - slip * slip.transpose() / (smooth * smooth)));
    }
}

}  // namespace cloth
