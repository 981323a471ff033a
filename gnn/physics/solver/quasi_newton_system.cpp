#include "gnn/physics/solver/quasi_newton_system.h"

#include <algorithm>
#include <cstring>

namespace cloth {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

// Largest diagonal entry over mean inertia of matrices that single precision solves to 6e-3: what a
// solve leaves of a smooth force is rounding (6e-8) times this. Soft cotton of 50,000 vertices is
// at 5.4e4: ten iterations from there reach the same energies as in double precision.
constexpr double most_stiffness = 1e5;

template <typename Array>
bool are_same_bits(const Array& a, const Array& b) {
    return a.rows() == b.rows() &&
           std::memcmp(a.data(), b.data(),
                       static_cast<size_t>(a.size()) * sizeof(typename Array::Scalar)) == 0;
}

// Half the cotangent of the angle at `apex` weighs the edge opposite to it.
void add_corner(const Points& x, int apex, int i, int j, Triplets& triplets) {
    const Vec3 a = x.row(i) - x.row(apex);
    const Vec3 b = x.row(j) - x.row(apex);
    const double weight = 0.5 * a.dot(b) / a.cross(b).norm();
    triplets.emplace_back(i, i, weight);
    triplets.emplace_back(j, j, weight);
    triplets.emplace_back(i, j, -weight);
    triplets.emplace_back(j, i, -weight);
}

/// The systems that somebody has.
struct Known {
    std::mutex mutex;
    std::vector<std::weak_ptr<QuasiNewtonSystem>> systems;
};

Known& known() {
    static Known all;
    return all;
}

}  // namespace

Eigen::SparseMatrix<double> cotangent_laplacian(const TriMesh& rest) {
    Triplets triplets;
    triplets.reserve(static_cast<size_t>(12 * rest.faces.rows()));
    for (Eigen::Index f = 0; f < rest.faces.rows(); ++f) {
        for (int corner = 0; corner < 3; ++corner)
            add_corner(rest.vertices, rest.faces(f, corner), rest.faces(f, (corner + 1) % 3),
                       rest.faces(f, (corner + 2) % 3), triplets);
    }
    Eigen::SparseMatrix<double> laplacian(rest.vertices.rows(), rest.vertices.rows());
    laplacian.setFromTriplets(triplets.begin(), triplets.end());
    return laplacian;
}

std::shared_ptr<QuasiNewtonSystem> QuasiNewtonSystem::of(const Garment& garment) {
    const std::lock_guard<std::mutex> lock(known().mutex);
    auto& systems = known().systems;
    systems.erase(std::remove_if(systems.begin(), systems.end(),
                                 [](const auto& system) { return system.expired(); }),
                  systems.end());
    for (const auto& one : systems)
        if (auto system = one.lock(); system && system->is_of(garment)) return system;
    auto system = std::make_shared<QuasiNewtonSystem>(garment);
    systems.push_back(system);
    return system;
}

QuasiNewtonSystem::QuasiNewtonSystem(const Garment& garment)
    : m_rest(garment.rest()), m_fabric(garment.fabric()), m_pins(garment.pins()) {
    const Eigen::SparseMatrix<double> laplacian = cotangent_laplacian(garment.rest());
    number_free_vertices(garment, laplacian);
    const auto count = static_cast<Eigen::Index>(m_free.size());
    Triplets selection;
    for (size_t row = 0; row < m_free.size(); ++row)
        selection.emplace_back(static_cast<int>(row), m_free[row], 1.0);
    Eigen::SparseMatrix<double> select(count, garment.vertex_count());
    select.setFromTriplets(selection.begin(), selection.end());
    m_laplacian = select * laplacian * select.transpose();
    m_masses.resize(count);
    for (Eigen::Index row = 0; row < count; ++row)
        m_masses[row] = garment.masses()[m_free[static_cast<size_t>(row)]];
}

/// In the order in which the factor eliminates them, so that a solve need not change the order.
void QuasiNewtonSystem::number_free_vertices(const Garment& garment,
                                             const Eigen::SparseMatrix<double>& laplacian) {
    m_row_of.assign(garment.is_pinned().size(), -1);
    for (const int vertex : elimination_order(laplacian)) {
        if (garment.is_pinned()[static_cast<size_t>(vertex)]) continue;
        m_row_of[static_cast<size_t>(vertex)] = static_cast<int>(m_free.size());
        m_free.push_back(vertex);
    }
}

bool QuasiNewtonSystem::is_of(const Garment& garment) const {
    return is_of(garment.fabric()) && m_pins == garment.pins() &&
           are_same_bits(m_rest.vertices, garment.rest().vertices) &&
           are_same_bits(m_rest.faces, garment.rest().faces);
}

/// As far as P depends on it.
bool QuasiNewtonSystem::is_of(const Fabric& fabric) const {
    return m_fabric.density == fabric.density && m_fabric.mu == fabric.mu &&
           m_fabric.lambda == fabric.lambda;
}

std::shared_ptr<const QuasiNewtonSystem::Factor> QuasiNewtonSystem::factor(double dt) {
    const std::lock_guard<std::mutex> lock(m_mutex);
    const auto kept = m_factors.find(dt);
    if (kept != m_factors.end())
        if (auto factor = kept->second.lock()) return factor;
    auto factor = std::make_shared<Factor>();
    factor->dt = dt;
    if (!m_free.empty()) {
        const Eigen::SparseMatrix<double> p = matrix(dt);
        if (!factor->exact.factorise(p)) return nullptr;
        if (p.diagonal().maxCoeff() <= most_stiffness * (m_masses.mean() / (dt * dt)))
            factor->fast = SupernodalCholesky<float>(factor->exact);
    }
    for (auto it = m_factors.begin(); it != m_factors.end();)
        it = it->second.expired() ? m_factors.erase(it) : std::next(it);
    m_factors[dt] = factor;
    return factor;
}

Eigen::SparseMatrix<double> QuasiNewtonSystem::matrix(double dt) const {
    Eigen::SparseMatrix<double> matrix = m_fabric.longitudinal() * m_laplacian;
    for (Eigen::Index row = 0; row < m_masses.size(); ++row)
        matrix.coeffRef(row, row) += m_masses[row] / (dt * dt);
    return matrix;
}

}  // namespace cloth
