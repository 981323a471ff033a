#include "gnn/physics/solver/quasi_newton_matrix.h"

#include <algorithm>
#include <cmath>

#include "gnn/physics/solver/dot.h"

namespace cloth {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

// Largest diagonal entry over mean inertia of matrices that single precision solves to 6e-3: what a
// solve leaves of a smooth force is rounding (6e-8) times this. Soft cotton of 50,000 vertices is
// at 5.4e4: ten iterations from there reach the same energies as in double precision.
constexpr double most_stiffness = 1e5;

bool same_fabric(const Fabric& a, const Fabric& b) {
    return a.density == b.density && a.mu == b.mu && a.lambda == b.lambda;
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

QuasiNewtonMatrix::QuasiNewtonMatrix(const Garment& garment)
    : m_vertex_count(garment.vertex_count()), m_pins(garment.pins()) {
    const Eigen::SparseMatrix<double> laplacian = cotangent_laplacian(garment.rest());
    number_free_vertices(garment, laplacian);
    Triplets selection;
    for (size_t row = 0; row < m_free.size(); ++row)
        selection.emplace_back(static_cast<int>(row), m_free[row], 1.0);
    Eigen::SparseMatrix<double> select(free_count(), m_vertex_count);
    select.setFromTriplets(selection.begin(), selection.end());
    m_masses.resize(free_count());
    m_laplacian = select * laplacian * select.transpose();
    for (Points* array : {&m_residual, &m_preconditioned, &m_direction, &m_product, &m_p_direction})
        array->resize(free_count(), 3);
}

/// In the order in which the factor eliminates them, so that a solve need not change the order.
void QuasiNewtonMatrix::number_free_vertices(const Garment& garment,
                                             const Eigen::SparseMatrix<double>& laplacian) {
    m_row_of.assign(static_cast<size_t>(m_vertex_count), -1);
    for (const int vertex : elimination_order(laplacian)) {
        if (garment.is_pinned()[static_cast<size_t>(vertex)]) continue;
        m_row_of[static_cast<size_t>(vertex)] = static_cast<int>(m_free.size());
        m_free.push_back(vertex);
    }
}

bool QuasiNewtonMatrix::Factor::factorise(const Eigen::SparseMatrix<double>& matrix,
                                          double mean_inertia) {
    if (!exact.factorise(matrix)) return false;
    if (matrix.diagonal().maxCoeff() <= most_stiffness * mean_inertia)
        fast = SupernodalCholesky<float>(exact);
    return true;
}

void QuasiNewtonMatrix::precondition(const Points& b, Points& out) const {
    const Factor& factor = m_factors.front();
    if (factor.fast.size() > 0)
        factor.fast.solve(b, out);
    else
        factor.exact.solve(b, out);
}

bool QuasiNewtonMatrix::prepare(const Garment& garment, double dt) {
    m_deflated = false;
    if (!same_fabric(m_fabric, garment.fabric())) m_factors.clear();
    m_fabric = garment.fabric();
    const auto kept = std::find_if(m_factors.begin(), m_factors.end(),
                                   [dt](const Factor& factor) { return factor.dt == dt; });
    if (kept != m_factors.end()) {
        m_factors.splice(m_factors.begin(), m_factors, kept);
        return true;
    }
    for (Eigen::Index row = 0; row < free_count(); ++row)
        m_masses[row] = garment.masses()[m_free[static_cast<size_t>(row)]];
    if (m_factors.size() == max_factors) m_factors.pop_back();
    m_factors.push_front({dt, {}, {}});
    ++m_factorisations;
    if (free_count() == 0 ||
        m_factors.front().factorise(assembled(dt), m_masses.mean() / (dt * dt)))
        return true;
    m_factors.pop_front();
    return false;
}

Eigen::SparseMatrix<double> QuasiNewtonMatrix::assembled(double dt) const {
    Eigen::SparseMatrix<double> matrix = m_fabric.longitudinal() * m_laplacian;
    for (Eigen::Index row = 0; row < free_count(); ++row)
        matrix.coeffRef(row, row) += m_masses[row] / (dt * dt);
    return matrix;
}

Eigen::SparseMatrix<double> QuasiNewtonMatrix::matrix() const {
    return assembled(m_factors.front().dt);
}

bool QuasiNewtonMatrix::fits(const Garment& garment) const {
    return garment.vertex_count() == m_vertex_count && garment.pins() == m_pins;
}

void QuasiNewtonMatrix::gather(const Points& all, Points& free) const {
    free.resize(free_count(), 3);
    for (Eigen::Index row = 0; row < free_count(); ++row)
        free.row(row) = all.row(m_free[static_cast<size_t>(row)]);
}

void QuasiNewtonMatrix::gather_difference(const Points& a, const Points& b, Points& free) const {
    free.resize(free_count(), 3);
    for (Eigen::Index row = 0; row < free_count(); ++row) {
        const int vertex = m_free[static_cast<size_t>(row)];
        free.row(row) = a.row(vertex) - b.row(vertex);
    }
}

void QuasiNewtonMatrix::scatter(const Points& free, Points& all) const {
    all.setZero(m_vertex_count, 3);
    add_scaled(1.0, free, all);
}

void QuasiNewtonMatrix::add_scaled(double scale, const Points& free, Points& all) const {
    for (Eigen::Index row = 0; row < free_count(); ++row)
        all.row(m_free[static_cast<size_t>(row)]) += scale * free.row(row);
}

void QuasiNewtonMatrix::deflate(const Points& x) {
    gather(x, m_points);
    const double dt = m_factors.front().dt;
    m_affine.take(m_points, m_laplacian, m_fabric.longitudinal(), m_masses, 1.0 / (dt * dt));
    m_deflated = true;
}

void QuasiNewtonMatrix::solve(const Points& b, ContactHessian& contacts, int iterations,
                              Points& out) const {
    m_residual = b;
    precondition(m_residual, m_preconditioned);
    if (!contacts.anticipate(m_preconditioned)) return solve(b, out);
    double power = dot(m_residual, m_preconditioned);
    const double enough = 1e-6 * power;  // a few contacts are solved before the iterations end
    const bool deflated = m_deflated && m_affine.factorise(contacts);
    if (deflated) {
        m_affine.solve(b, out, m_product);
        contacts.add_product(out, m_product);
        m_residual -= m_product;
        precondition(m_residual, m_preconditioned);
        power = dot(m_residual, m_preconditioned);
    } else {
        out.setZero(b.rows(), 3);
    }
    m_direction.setZero(b.rows(), 3);
    // P times the direction follows from the residuals, so that P itself is never multiplied.
    m_p_direction.setZero(b.rows(), 3);
    double beta = 0.0;
    for (int k = 0; power > enough; ++k) {
        if (deflated) {
            m_affine.add_conjugate(contacts, m_preconditioned, m_residual, beta, m_direction,
                                   m_p_direction);
        } else {
            m_direction = m_preconditioned + beta * m_direction;
            m_p_direction = m_residual + beta * m_p_direction;
        }
        m_product = m_p_direction;
        contacts.add_product(m_direction, m_product);
        const double step = power / dot(m_direction, m_product);
        out += step * m_direction;
        if (k + 1 >= iterations) break;
        m_residual -= step * m_product;
        precondition(m_residual, m_preconditioned);
        const double next_power = dot(m_residual, m_preconditioned);
        beta = next_power / power;
        power = next_power;
    }
}

}  // namespace cloth
