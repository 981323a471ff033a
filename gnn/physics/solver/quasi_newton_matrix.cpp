#include "gnn/physics/solver/quasi_newton_matrix.h"

#include <algorithm>

#include "gnn/physics/solver/dot.h"

namespace cloth {

QuasiNewtonMatrix::QuasiNewtonMatrix(const Garment& garment)
    : m_vertex_count(garment.vertex_count()), m_system(QuasiNewtonSystem::of(garment)) {
    for (Points* array : {&m_residual, &m_preconditioned, &m_direction, &m_product, &m_p_direction})
        array->resize(free_count(), 3);
}

void QuasiNewtonMatrix::precondition(const Points& b, Points& out) const {
    const QuasiNewtonSystem::Factor& factor = *m_factors.front();
    if (factor.fast.size() > 0)
        factor.fast.solve(b, out);
    else
        factor.exact.solve(b, out);
}

bool QuasiNewtonMatrix::prepare(const Garment& garment, double dt) {
    m_deflated = false;
    if (!m_system->is_of(garment.fabric())) {
        m_factors.clear();
        m_system = QuasiNewtonSystem::of(garment);
    }
    const auto kept = std::find_if(m_factors.begin(), m_factors.end(),
                                   [dt](const auto& factor) { return factor->dt == dt; });
    if (kept != m_factors.end()) {
        m_factors.splice(m_factors.begin(), m_factors, kept);
        return true;
    }
    if (m_factors.size() == max_factors) m_factors.pop_back();
    ++m_factorisations;
    auto factor = m_system->factor(dt);
    if (!factor) return false;
    m_factors.push_front(std::move(factor));
    return true;
}

Eigen::SparseMatrix<double> QuasiNewtonMatrix::matrix() const {
    return m_system->matrix(m_factors.front()->dt);
}

bool QuasiNewtonMatrix::fits(const Garment& garment) const {
    return garment.vertex_count() == m_vertex_count && garment.pins() == m_system->pins();
}

void QuasiNewtonMatrix::gather(const Points& all, Points& free) const {
    free.resize(free_count(), 3);
    for (Eigen::Index row = 0; row < free_count(); ++row)
        free.row(row) = all.row(m_system->free()[static_cast<size_t>(row)]);
}

void QuasiNewtonMatrix::gather_difference(const Points& a, const Points& b, Points& free) const {
    free.resize(free_count(), 3);
    for (Eigen::Index row = 0; row < free_count(); ++row) {
        const int vertex = m_system->free()[static_cast<size_t>(row)];
        free.row(row) = a.row(vertex) - b.row(vertex);
    }
}

void QuasiNewtonMatrix::scatter(const Points& free, Points& all) const {
    all.setZero(m_vertex_count, 3);
    add_scaled(1.0, free, all);
}

void QuasiNewtonMatrix::add_scaled(double scale, const Points& free, Points& all) const {
    for (Eigen::Index row = 0; row < free_count(); ++row)
        all.row(m_system->free()[static_cast<size_t>(row)]) += scale * free.row(row);
}

void QuasiNewtonMatrix::deflate(const Points& x) {
    gather(x, m_points);
    const double dt = m_factors.front()->dt;
    m_affine.take(m_points, m_system->laplacian(), m_system->fabric().longitudinal(),
                  m_system->masses(), 1.0 / (dt * dt));
    m_deflated = true;
    m_deflated_factor = m_factors.front();
}

bool QuasiNewtonMatrix::deflate_as_before() {
    m_deflated = !m_factors.empty() && m_deflated_factor.lock() == m_factors.front();
    return m_deflated;
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
