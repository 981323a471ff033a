#include "gnn/physics/solver/quasi_newton_matrix.h"

#include <algorithm>

namespace cloth {

QuasiNewtonMatrix::QuasiNewtonMatrix(const Garment& garment)
    : m_vertex_count(garment.vertex_count()), m_system(QuasiNewtonSystem::of(garment)) {
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
    if (m_factors.front()->fast.size() > 0)
        m_fast_cg.take_fields(m_affine);
    else
        m_exact_cg.take_fields(m_affine);
    m_deflated = true;
    m_deflated_factor = m_factors.front();
}

bool QuasiNewtonMatrix::deflate_as_before() {
    m_deflated = !m_factors.empty() && m_deflated_factor.lock() == m_factors.front();
    return m_deflated;
}

void QuasiNewtonMatrix::solve(const Points& b, ContactHessian& contacts, int iterations,
                              Points& out) const {
    const QuasiNewtonSystem::Factor& factor = *m_factors.front();
    if (factor.fast.size() > 0)
        solve(factor.fast, m_fast_cg, b, contacts, iterations, out);
    else if (factor.exact.size() > 0)
        solve(factor.exact, m_exact_cg, b, contacts, iterations, out);
    else
        solve(b, out);
}

template <class Real>
void QuasiNewtonMatrix::solve(const SupernodalCholesky<Real>& factor, DeflatedCg<Real>& cg,
                              const Points& b, ContactHessian& contacts, int iterations,
                              Points& out) const {
    if (contacts.anticipate(cg.start(factor, b)))
        cg.solve(contacts, m_deflated ? &m_affine : nullptr, iterations, out);
    else
        solve(b, out);
}

void QuasiNewtonMatrix::prepare_hessian(const Garment& garment) {
    if (m_factors.empty()) return;
    if (m_factors.front()->fast.size() > 0)
        m_fast_hessian.prepare(garment, *m_system);
    else if (m_factors.front()->exact.size() > 0)
        m_exact_hessian.prepare(garment, *m_system);
}

void QuasiNewtonMatrix::solve(const Garment& garment, const Points& x, const Points& b,
                              ContactHessian& contacts, int iterations, Points& out) {
    const QuasiNewtonSystem::Factor& factor = *m_factors.front();
    if (factor.fast.size() > 0)
        solve(factor.fast, m_fast_hessian, garment, x, b, contacts, iterations, out);
    else if (factor.exact.size() > 0)
        solve(factor.exact, m_exact_hessian, garment, x, b, contacts, iterations, out);
    else
        solve(b, out);
}

template <class Real>
void QuasiNewtonMatrix::solve(const SupernodalCholesky<Real>& factor, HessianSolver<Real>& solver,
                              const Garment& garment, const Points& x, const Points& b,
                              ContactHessian& contacts, int iterations, Points& out) {
    solver.prepare(garment, *m_system);
    solver.hessian->begin_step(*m_system, m_factors.front()->dt);
    contacts.anticipate(solver.cg.start(factor, b));
    solver.cg.solve(*solver.hessian, x, contacts, iterations, out);
}

}  // namespace cloth
