#include "gnn/physics/solver/affine_correction.h"

namespace cloth {
namespace {

using RowLanes = double __attribute__((vector_size(32)));  // x, y, z and a spare lane

RowLanes load_row(const double* p) {
    return RowLanes{p[0], p[1], p[2], 0.0};
}

/// out = a + scale out - fields c, row by row.
void add_rows(const Points& a, double scale, const AffineFields::Columns& fields,
              const AffineFields::Coefficients& c, Points& out) {
    RowLanes rows[AffineFields::count];
    for (int k = 0; k < AffineFields::count; ++k) rows[k] = load_row(c.row(k).data());
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
        double* const to = out.data() + 3 * i;
        const double* const f = fields.data() + AffineFields::count * i;
        RowLanes sum = load_row(a.data() + 3 * i) + scale * load_row(to);
        for (int k = 0; k < AffineFields::count; ++k) sum -= f[k] * rows[k];
        for (int k = 0; k < 3; ++k) to[k] = sum[k];
    }
}

}  // namespace

void AffineCorrection::take(const Points& x, const Eigen::SparseMatrix<double>& laplacian,
                            double stiffness, const VectorX& masses, double rate) {
    m_fields.take(x);
    const AffineFields::Columns& fields = m_fields.columns();
    m_p_columns.noalias() = laplacian * fields;
    m_p_columns *= stiffness;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        m_p_columns.row(i) += rate * masses[i] * fields.row(i);
    m_p.noalias() = fields.transpose().lazyProduct(m_p_columns);
    // a field that is zero has no part in any answer
    for (int k = 0; k < AffineFields::count; ++k)
        if (!(m_p(k, k) > 0.0)) m_p(k, k) = m_p(0, 0);
}

bool AffineCorrection::factorise(const ContactHessian& contacts) {
    AffineFields::System system = AffineFields::System::Zero();
    AffineFields::add_isotropic(m_p, system);
    contacts.add_to(m_fields, system);
    m_factor.compute(system);
    return m_factor.info() == Eigen::Success && m_factor.isPositive();
}

AffineFields::Coefficients AffineCorrection::coefficients(
    const AffineFields::Coefficients& moments) const {
    using Vector = AffineFields::Vector;
    const Vector answer = m_factor.solve(Vector(Eigen::Map<const Vector>(moments.data())));
    return Eigen::Map<const AffineFields::Coefficients>(answer.data());
}

void AffineCorrection::solve(const Points& b, Points& x, Points& p_x) const {
    const AffineFields::Coefficients c = coefficients(m_fields.moments(b));
    x.noalias() = m_fields.columns().lazyProduct(c);
    p_x.noalias() = m_p_columns.lazyProduct(c);
}

void AffineCorrection::add_conjugate(const ContactHessian& contacts, const Points& z,
                                     const Points& residual, double beta, Points& direction,
                                     Points& p_direction) const {
    // F' A z = F' residual + F' blocks z, and the residual has no affine part
    AffineFields::Coefficients moments = AffineFields::Coefficients::Zero();
    contacts.add_moments(m_fields, z, moments);
    const AffineFields::Coefficients c = coefficients(moments);
    add_rows(z, beta, m_fields.columns(), c, direction);
    add_rows(residual, beta, m_p_columns, c, p_direction);
}

}  // namespace cloth
