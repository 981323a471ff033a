#include "gnn/physics/stepper/untangling.h"

#include <algorithm>
#include <cmath>

#include "collision/response/resolve.h"

namespace cloth {
namespace {

constexpr int smoothing = 4;        // rounds, on the forces and once more on the motions
constexpr double steepest = 4.0;    // see TangleMeasure::gradient()
constexpr double farthest = 0.5;    // move of a vertex, in thicknesses
constexpr int halvings = 5;         // of a move that does not lower the energy
constexpr int push_iterations = 3;  // of push_out_rows

}  // namespace

Untangling::Untangling(const Garment& garment, const SelfContactSettings& settings)
    : m_garment(&garment),
      m_settings(settings),
      m_elastic(garment),
      m_measure(garment),
      m_mobility(garment.mobilities()) {
    check_self_contact(settings);
    std::vector<int> degree(static_cast<size_t>(garment.vertex_count()), 0);
    for (const auto& edge : garment.edges())
        for (const int i : edge) ++degree[static_cast<size_t>(i)];
    const auto share = [&](int i) {
        return 0.5 * garment.masses()[i] / degree[static_cast<size_t>(i)];
    };
    for (const auto& [p, q] : garment.edges()) m_exchange.push_back(std::min(share(p), share(q)));
}

UntanglingReport Untangling::run(const Surroundings& outside, double dt, ClothState& state) {
    UntanglingReport report;
    m_x = state.x;
    measure(outside.boundary);
    report.before = m_size;
    while (report.moves < m_settings.untangling_moves && m_size > 0.0 && move(outside))
        ++report.moves;
    report.after = m_size;
    if (report.moves == 0) return report;
    slow_down(dt, m_x, state);
    state.x = m_x;
    return report;
}

void Untangling::measure(const Boundary& boundary) {
    m_size = m_measure.find(m_x, m_settings.threads, nullptr, boundary.overlapped);
    m_energy = energy(boundary, m_x) + m_settings.untangling_tension * m_size;
}

/// One move of m_x; false: none lowers the energy.
bool Untangling::move(const Surroundings& outside) {
    m_measure.gradient(m_x, m_gradient, steepest);
    if (!find_direction(outside)) return false;
    m_wrong = m_measure.regions().wrong();
    double step = 1.0;
    for (int k = 0; k <= halvings; ++k, step *= 0.5) {
        m_trial = m_x + step * m_direction;
        hold(outside);
        const double size =
            m_measure.find(m_trial, m_settings.threads, &m_wrong, outside.boundary.overlapped);
        const double value =
            energy(outside.boundary, m_trial) + m_settings.untangling_tension * size;
        if (!(value < m_energy)) continue;
        m_x.swap(m_trial);
        m_energy = value;
        m_size = size;
        if (m_measure.regions().left_out()) measure(outside.boundary);
        return true;
    }
    m_measure.find(m_x, m_settings.threads, nullptr, outside.boundary.overlapped);
    return false;
}

/// Both smoothings, one of which is the other's transpose, leave a direction of descent and the
/// centre of mass in place.
bool Untangling::find_direction(const Surroundings& outside) {
    m_direction = -m_gradient;
    smooth_forces();
    for (Eigen::Index i = 0; i < m_direction.rows(); ++i) m_direction.row(i) *= m_mobility[i];
    smooth_motions();
    const double longest = std::sqrt(m_direction.rowwise().squaredNorm().maxCoeff());
    if (!(longest > 0.0) || !std::isfinite(longest)) return false;
    m_direction *= farthest * m_settings.thickness / longest;
    keep_out(outside);
    return true;
}

void Untangling::smooth_forces() {
    for (int round = 0; round < smoothing; ++round)
        for (size_t e = 0; e < m_exchange.size(); ++e) {
            const auto& [p, q] = m_garment->edges()[e];
            const Eigen::RowVector3d flow = m_exchange[e] * (m_mobility[p] * m_direction.row(p) -
                                                             m_mobility[q] * m_direction.row(q));
            m_direction.row(p) -= flow;
            m_direction.row(q) += flow;
        }
}

/// Edges in the opposite order.
void Untangling::smooth_motions() {
    for (int round = 0; round < smoothing; ++round)
        for (size_t e = m_exchange.size(); e-- > 0;) {
            const auto& [p, q] = m_garment->edges()[e];
            const Eigen::RowVector3d flow =
                m_exchange[e] * (m_direction.row(p) - m_direction.row(q));
            m_direction.row(p) -= m_mobility[p] * flow;
            m_direction.row(q) += m_mobility[q] * flow;
        }
}

/// Takes out what goes into an obstacle.
void Untangling::keep_out(const Surroundings& outside) {
    const SurfaceContacts& contacts = outside.contacts;
    for (size_t k = 0; k < contacts.obstacle.size(); ++k) {
        const Eigen::Index i = static_cast<Eigen::Index>(k);
        if (!contacts.has(i)) continue;
        const Eigen::RowVector3d normal = contacts.normal1.row(i);
        const double least = std::min(0.0, outside.distance - contacts.distance[i]);
        const double missing = least - normal.dot(m_direction.row(i));
        if (missing > 0.0 && m_mobility[i] > 0.0) m_direction.row(i) += missing * normal;
    }
}

/// Puts m_trial out of obstacles, and within the limits of goals.
void Untangling::hold(const Surroundings& outside) {
    if (!outside.boundary.obstacles.empty()) {
        m_rows.clear();
        for (Eigen::Index i = 0; i < m_trial.rows(); ++i)
            if (m_trial.row(i) != m_x.row(i)) m_rows.push_back(static_cast<int>(i));
        outside.proximity.query_rows(m_trial, m_rows, outside.boundary, outside.contacts,
                                     StepEnd::end);
        push_out_rows(outside.proximity, outside.boundary, outside.distance, push_iterations,
                      m_rows, m_trial, outside.contacts);
    }
    outside.goals.resolve(outside.proximity, outside.boundary, outside.distance, m_trial,
                          outside.contacts);
}

/// Without that of the tangles (J).
double Untangling::energy(const Boundary& boundary, const Points& x) const {
    const ElasticEnergy::Terms fabric = m_elastic.value(x);
    double energy = fabric.strain + fabric.bending;
    const VectorX& masses = m_garment->masses();
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        Vec3 acceleration = boundary.gravity;
        if (boundary.accelerations.rows() > 0)
            acceleration += boundary.accelerations.row(i).transpose();
        energy -= masses[i] * acceleration.dot(x.row(i));
    }
    return energy;
}

/// Cloth that goes back where it was drawn from would tremble: of the velocity, the part against
/// the motion is taken out, by one factor for the whole garment, which keeps momentum.
/// @param x  to which the state is moved (|V| x 3, m)
void Untangling::slow_down(double dt, const Points& x, ClothState& state) const {
    const VectorX& masses = m_garment->masses();
    double against = 0.0, squared = 0.0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const Eigen::RowVector3d motion = (x.row(i) - state.x.row(i)) / dt;
        against -= masses[i] * motion.dot(state.v.row(i));
        squared += masses[i] * motion.squaredNorm();
    }
    const double share = squared > 0.0 ? std::clamp(against / squared, 0.0, 1.0) : 0.0;
    if (share > 0.0) state.v += share / dt * (x - state.x);
}

}  // namespace cloth
