#include "gnn/physics/solver/affine_correction.h"

namespace cloth {

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

bool AffineCorrection::factorise(const AffineFields::System& blocks) {
    AffineFields::System system = blocks;
    AffineFields::add_isotropic(m_p, system);
    m_factor.compute(system);
    return m_factor.info() == Eigen::Success && m_factor.isPositive();
}

AffineFields::Coefficients AffineCorrection::coefficients(
    const AffineFields::Coefficients& moments) const {
    using Vector = AffineFields::Vector;
    const Vector answer = m_factor.solve(Vector(Eigen::Map<const Vector>(moments.data())));
    return Eigen::Map<const AffineFields::Coefficients>(answer.data());
}

}  // namespace cloth
