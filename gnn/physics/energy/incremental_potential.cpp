#include "gnn/physics/energy/incremental_potential.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr int separating_sweeps = 10;  // of a guess; what is left is the solver's

void require_rows(const char* name, Eigen::Index rows, Eigen::Index expected) {
    if (rows != expected)
        throw ArgumentError(name,
                            "has " + std::to_string(rows) + " rows where the garment has " +
                                std::to_string(expected) + " vertices",
                            "pass one row per vertex of the garment");
}

void check_settings(const PotentialSettings& settings) {
    const double distance = settings.contact_distance;
    check_range("PotentialSettings.contact_distance", distance, 1e-3, 1e-2);
    check_range("PotentialSettings.contact_weight", settings.contact_weight, 1e3, 1e6);
    check_range("PotentialSettings.ridge_distance", settings.ridge_distance, 0.0, distance);
    check_range("PotentialSettings.friction_scale", settings.friction_scale, 0.0, 10.0);
    check_range("PotentialSettings.friction_distance", settings.friction_distance, 0.0, 0.1);
    check_range("PotentialSettings.friction_slip_speed", settings.friction_slip_speed, 1e-5, 1.0);
    check_range("PotentialSettings.goal_stiffness", settings.goal_stiffness, 0.1, 1000.0);
    check_range("PotentialSettings.friction_limit", settings.friction_limit, 0.0, 100.0);
    check_range("PotentialSettings.pinch_pressure", settings.pinch_pressure, 0.0, 1e5);
}

// A layer that is not quite flat lies on the other with one in so many of its pairs.
constexpr double carrying_pairs = 3.0;

void require_goals(const Garment& garment, const SkinGoals& goals) {
    if (!are_goals_for(garment.goal_limits(), goals, garment.vertex_count()))
        throw ArgumentError("boundary.goals",
                            "are not those of " + garment.name() + ", which has goal limits",
                            "give each of its " + std::to_string(garment.vertex_count()) +
                                " vertices a finite goal, and a normal if it has backstops");
}

void validate_contacts(const SurfaceContacts& contacts, size_t obstacles, const Garment& garment) {
    for (const RidgeContact& ridge : contacts.ridges)
        if (ridge.face < 0 || ridge.face >= garment.face_count())
            throw ArgumentError("contacts.ridges",
                                "names face " + std::to_string(ridge.face) + " of " +
                                    std::to_string(garment.face_count()),
                                "find the ridges with the finder of this garment");
    if (contacts.obstacle.empty()) return;
    const Eigen::Index vertices = garment.vertex_count();
    require_rows("contacts.obstacle", static_cast<Eigen::Index>(contacts.obstacle.size()),
                 vertices);
    require_rows("contacts.point0", contacts.point0.rows(), vertices);
    require_rows("contacts.point1", contacts.point1.rows(), vertices);
    require_rows("contacts.normal0", contacts.normal0.rows(), vertices);
    require_rows("contacts.normal1", contacts.normal1.rows(), vertices);
    require_rows("contacts.distance", contacts.distance.rows(), vertices);
    for (int obstacle : contacts.obstacle)
        if (obstacle >= static_cast<int>(obstacles))
            throw ArgumentError(
                "contacts.obstacle",
                "names obstacle " + std::to_string(obstacle) + " of " + std::to_string(obstacles),
                "query the contacts with the boundary of this step");
}

}  // namespace

IncrementalPotential::IncrementalPotential(const Garment& garment, PotentialSettings settings)
    : m_garment(&garment),
      m_settings(settings),
      m_pattern(std::make_shared<const LazyBlockPattern>(garment)),
      m_elastic(garment),
      m_gravity(garment),
      m_inertia(garment),
      m_ridges(garment),
      m_self_contact(garment, settings.self_contact),
      m_goals(garment) {
    check_settings(settings);
}

void IncrementalPotential::begin_step(const ClothState& state, const Boundary& boundary,
                                      const SurfaceContacts& contacts, double dt,
                                      const InertialStep* inertia,
                                      const std::vector<char>& unrepelled) {
    const Eigen::Index count = m_garment->vertex_count();
    if (!(dt > 0.0) || !std::isfinite(dt))
        throw ArgumentError("dt", std::to_string(dt) + " is no time step", "pass seconds, above 0");
    require_rows("state.x", state.x.rows(), count);
    require_rows("state.v", state.v.rows(), count);
    if (boundary.accelerations.rows() > 0)
        require_rows("boundary.accelerations", boundary.accelerations.rows(), count);
    require_goals(*m_garment, boundary.goals);
    validate_contacts(contacts, boundary.obstacles.size(), *m_garment);

    m_dt = dt;
    m_contacts = contacts;
    m_inertial_dt = inertia ? inertia->dt : dt;
    m_inertia.begin_step(state, dt, inertia);
    m_gravity.begin_step(boundary.gravity, boundary.accelerations);
    m_contact.begin_step(contacts, m_settings.contact_distance);
    m_ridges.begin_step(contacts, m_settings.ridge_distance);
    m_friction.begin_step(
        *m_garment, state, boundary, contacts,
        {m_settings.friction_scale, m_settings.friction_distance,
         m_settings.friction_slip_speed * dt, m_settings.contact_distance,
         m_settings.contact_weight, m_settings.friction_limit, m_settings.pinch_pressure});
    m_self_contact.begin_step(state, dt, unrepelled);
    m_layer_friction.begin_step(
        m_self_contact, state.x, m_settings.friction_slip_speed * dt,
        carrying_pairs * m_settings.friction_limit * limiting_acceleration(boundary.gravity));
    m_goals.begin_step(state, boundary.goals, dt, m_settings.goal_stiffness);
    m_force_scale = norm_of_forces_at(state);
}

void IncrementalPotential::separate_self_contact(Points& guess) const {
    if (m_self_contact.pairs().empty()) return;
    for (int sweep = 0; sweep < separating_sweeps; ++sweep) {
        m_self_contact.separate(guess);
        lift_off_obstacles(guess);
    }
}

void IncrementalPotential::lift_off_obstacles(Points& x) const {
    for (size_t k = 0; k < m_contacts.obstacle.size(); ++k) {
        const Eigen::Index i = static_cast<Eigen::Index>(k);
        if (!m_contacts.has(i) || m_garment->is_pinned()[k]) continue;
        const Eigen::RowVector3d normal = m_contacts.normal1.row(i);
        const double depth =
            m_settings.contact_distance - normal.dot(x.row(i) - m_contacts.point1.row(i));
        if (depth > 0.0) x.row(i) += depth * normal;
    }
}

/// At least 1 % of the garment's weight on Earth: the residual stays defined for cloth at rest
/// without gravity and for cloth at the top of a throw, where inertia and gravity cancel.
double IncrementalPotential::norm_of_forces_at(const ClothState& state) const {
    const VectorX& stiffness = m_inertia.stiffness();
    double forces = 0.0, weights = 0.0;
    for (Eigen::Index i = 0; i < m_garment->vertex_count(); ++i) {
        if (m_garment->is_pinned()[static_cast<size_t>(i)]) continue;
        forces += (stiffness[i] * (state.x.row(i) - m_inertia.target().row(i)) -
                   m_gravity.forces().row(i))
                      .squaredNorm();
        weights += std::pow(9.81 * m_garment->masses()[i], 2);
    }
    const double scale = std::max(std::sqrt(forces), 0.01 * std::sqrt(weights));
    return scale > 0.0 ? scale : 1.0;
}

EnergyTerms IncrementalPotential::terms(const Points& x) const {
    EnergyTerms terms;
    const ElasticEnergy::Terms elastic = m_elastic.value(x);
    terms.strain = elastic.strain;
    terms.bending = elastic.bending;
    terms.gravity = m_gravity.value(x);
    terms.inertia = m_inertia.value(x);
    terms.contact = m_contact.value(x, m_settings.contact_weight) +
                    m_ridges.value(x, m_settings.contact_weight);
    terms.friction = m_friction.value(x) + m_layer_friction.value(x);
    terms.self_contact = m_self_contact.value(x);
    terms.goals = m_goals.value(x);
    return terms;
}

double IncrementalPotential::value(const Points& x) const {
    return terms(x).total();
}

double IncrementalPotential::value_of_motion(const Points& x) const {
    return m_gravity.value(x) + m_inertia.value(x);
}

double IncrementalPotential::value_gradient(const Points& x, Points& gradient,
                                            Points* elastic) const {
    const ElasticEnergy::Terms fabric = m_elastic.gradient(x, gradient);
    EnergyTerms terms;
    terms.strain = fabric.strain;
    terms.bending = fabric.bending;
    if (elastic) {
        *elastic = gradient;
        mask_pins(*elastic);
    }
    terms.gravity = m_gravity.add_gradient(x, gradient);
    terms.inertia = m_inertia.add_gradient(x, gradient);
    terms.contact = m_contact.add_gradient(x, m_settings.contact_weight, gradient) +
                    m_ridges.add_gradient(x, m_settings.contact_weight, gradient);
    terms.friction =
        m_friction.add_gradient(x, gradient) + m_layer_friction.add_gradient(x, gradient);
    terms.self_contact = m_self_contact.add_gradient(x, gradient);
    terms.goals = m_goals.add_gradient(x, gradient);
    mask_pins(gradient);
    return terms.total();
}

void IncrementalPotential::elastic_gradient(const Points& x, Points& gradient) const {
    m_elastic.gradient(x, gradient);
    mask_pins(gradient);
}

void IncrementalPotential::internal_forces(const Points& x, Points& forces) const {
    m_elastic.gradient(x, forces);
    forces = -forces;
}

double IncrementalPotential::internal_energy(const Points& x) const {
    const ElasticEnergy::Terms terms = m_elastic.value(x);
    return terms.strain + terms.bending;
}

void IncrementalPotential::hessian(const Points& x, Eigen::SparseMatrix<double>& hessian,
                                   HessianKind kind) const {
    const BlockPattern& pattern = m_pattern->get();
    pattern.reset(hessian);
    double* values = hessian.valuePtr();
    m_elastic.add_hessian(x, pattern, kind, values);
    m_inertia.add_hessian(pattern, values);
    m_contact.add_hessian(x, m_settings.contact_weight, pattern, values);
    m_ridges.add_hessian(x, m_settings.contact_weight, pattern, values);
    m_friction.add_hessian(x, pattern, values);
    m_goals.add_hessian(x, pattern, values);
    m_self_contact.add_hessian(x, hessian);
    m_layer_friction.add_hessian(x, m_garment->is_pinned(), hessian);
}

void IncrementalPotential::mask_pins(Points& gradient) const {
    for (int pin : m_garment->pins()) gradient.row(pin).setZero();
}

}  // namespace cloth
