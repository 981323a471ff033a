#include "gnn/physics/energy/self_contact.h"

#include <algorithm>
#include <cmath>

namespace cloth {
namespace {

// What may be added to the motion with the velocities at t, in thicknesses. Cloth that comes nearer
// by more, such as by a frame's free fall, is left to contact projection: to look for it here
// makes a step twice as expensive and saves few frames.
constexpr double slack = 0.5;
constexpr double entry_depth = 1e-4;  // m, per trial step; see ContactHessian

}  // namespace

SelfContactEnergy::SelfContactEnergy(const Garment& garment, const SelfContactSettings& settings)
    : m_settings(settings) {
    check_self_contact(settings);
    if (!settings.on()) return;
    m_proximity.emplace(garment, settings.thickness);
    m_inverse_masses = garment.inverse_masses();
    m_mean_mass = garment.masses().mean();
    m_area = garment.masses() / m_mean_mass;
    m_vertex_pairs.assign(static_cast<size_t>(garment.vertex_count()), 0);
    m_edge_pairs.assign(garment.edges().size(), 0);
}

void SelfContactEnergy::begin_step(const ClothState& state, double dt,
                                   const std::vector<char>& unrepelled) {
    if (!on()) return;
    m_motion = dt * state.v;
    m_proximity->find(state.x, m_motion, (1.0 + slack) * thickness(), m_settings.threads);
    take_pairs(unrepelled);
}

void SelfContactEnergy::take_pairs(const std::vector<char>& unrepelled) {
    std::fill(m_vertex_pairs.begin(), m_vertex_pairs.end(), 0);
    std::fill(m_edge_pairs.begin(), m_edge_pairs.end(), 0);
    for (const SelfPair& pair : m_proximity->pairs()) {
        const auto [first, second] = pair.elements.element;
        if (pair.elements.edges) {
            ++m_edge_pairs[static_cast<size_t>(first)];
            ++m_edge_pairs[static_cast<size_t>(second)];
        } else {
            ++m_vertex_pairs[static_cast<size_t>(first)];
        }
    }
    m_pairs.clear();
    m_pairs_of_vertices = 0;
    for (const SelfPair& pair : m_proximity->pairs()) {
        if (has_any(pair.elements, unrepelled)) continue;
        const std::array<int, 4>& v = pair.elements.vertex;
        const auto [first, second] = pair.elements.element;
        double share = 0.0;
        if (pair.elements.edges)  // three edges to a vertex
            share = (m_area[v[0]] + m_area[v[1]] + m_area[v[2]] + m_area[v[3]]) / 12.0 /
                    std::max(m_edge_pairs[static_cast<size_t>(first)],
                             m_edge_pairs[static_cast<size_t>(second)]);
        else
            share = m_area[v[0]] / m_vertex_pairs[static_cast<size_t>(first)];
        m_pairs.push_back({v, pair.weight, pair.normal, m_settings.weight * share, pair.distance,
                           m_mean_mass * share});
        if (!pair.elements.edges) ++m_pairs_of_vertices;
    }
}

double SelfContactEnergy::value(const Points& x) const {
    double energy = 0.0;
    for (const Pair& pair : m_pairs) {
        const double depth = thickness() - pair.distance(x);
        if (depth > 0.0) energy += pair.stiffness * depth * depth * depth;
    }
    return energy;
}

double SelfContactEnergy::add_gradient(const Points& x, Points& gradient) const {
    double energy = 0.0;
    for (const Pair& pair : m_pairs) {
        const double depth = thickness() - pair.distance(x);
        if (!(depth > 0.0)) continue;
        const Eigen::RowVector3d force =
            (3.0 * pair.stiffness * depth * depth) * pair.normal.transpose();
        for (size_t k = 0; k < 4; ++k) gradient.row(pair.vertex[k]) -= pair.weight[k] * force;
        energy += pair.stiffness * depth * depth * depth;
    }
    return energy;
}

void SelfContactEnergy::add_hessian(const Points& x, Eigen::SparseMatrix<double>& hessian) const {
    if (m_pairs.empty()) return;
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(144 * m_pairs.size());
    for (const Pair& pair : m_pairs) {
        const double depth = std::max(0.0, thickness() - pair.distance(x));
        const Eigen::Matrix3d block =
            (6.0 * pair.stiffness * depth) * pair.normal * pair.normal.transpose();
        for (size_t a = 0; a < 4; ++a)
            for (size_t b = 0; b < 4; ++b) {
                const int row = pair.vertex[a], column = pair.vertex[b];
                if (m_inverse_masses[row] == 0.0 || m_inverse_masses[column] == 0.0) continue;
                const double weight = pair.weight[a] * pair.weight[b];
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        triplets.emplace_back(3 * row + i, 3 * column + j, weight * block(i, j));
            }
    }
    Eigen::SparseMatrix<double> contact(hessian.rows(), hessian.cols());
    contact.setFromTriplets(triplets.begin(), triplets.end());
    hessian += contact;
}

void SelfContactEnergy::lift(const Pair& pair, double height, Points& x) const {
    std::array<double, 4> motion;
    double mobility = 0.0;
    for (size_t k = 0; k < 4; ++k) {
        motion[k] = pair.weight[k] * m_inverse_masses[pair.vertex[k]];
        mobility += pair.weight[k] * motion[k];
    }
    if (!(mobility > 0.0)) return;
    for (size_t k = 0; k < 4; ++k)
        x.row(pair.vertex[k]) += height / mobility * motion[k] * pair.normal.transpose();
}

void SelfContactEnergy::separate(Points& x) const {
    for (const Pair& pair : m_pairs) {
        const double missing = std::min(thickness(), pair.start) - pair.distance(x);
        if (missing > 0.0) lift(pair, missing, x);
    }
}

void SelfContactEnergy::limit_entry(const Points& from, Points& trial) const {
    for (const Pair& pair : m_pairs) {
        const double here = pair.distance(trial);
        if (!(here < thickness() - entry_depth)) continue;
        const double missing = std::min(thickness(), pair.distance(from)) - entry_depth - here;
        if (missing > 0.0) lift(pair, missing, trial);
    }
}

}  // namespace cloth
