#include "gnn/physics/solver/affine_fields.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace cloth {
namespace {

// Points whose extent is less than this share of the largest do not define a linear field.
constexpr double least_extent = 1e-3;

}  // namespace

void AffineFields::take(const Points& x) {
    m_columns.resize(x.rows(), count);
    if (x.rows() == 0) return;
    const Eigen::RowVector3d centre = x.colwise().mean();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const Eigen::RowVector3d y = x.row(i) - centre;
        covariance += y.transpose() * y;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance /
                                                              static_cast<double>(x.rows()));
    const Vec3& variance = axes.eigenvalues();
    Eigen::Matrix3d scaled = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k)
        if (variance[k] > least_extent * least_extent * variance[2])
            scaled.col(k) = axes.eigenvectors().col(k) / std::sqrt(variance[k]);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        m_columns(i, 0) = 1.0;
        m_columns.row(i).tail<3>() = (x.row(i) - centre) * scaled;
    }
}

AffineFields::Coefficients AffineFields::moments(const Points& a) const {
    Coefficients sum = Coefficients::Zero();
    for (Eigen::Index i = 0; i < a.rows(); ++i)
        sum.noalias() += m_columns.row(i).transpose() * a.row(i);
    return sum;
}

void AffineFields::add(const Weights& weights, int row, int column, System& system) {
    for (int i = 0; i < count; ++i)
        for (int j = 0; j < count; ++j) system(3 * i + row, 3 * j + column) += weights(i, j);
}

void AffineFields::add_isotropic(const Weights& weights, System& system) {
    for (int d = 0; d < 3; ++d) add(weights, d, d, system);
}

}  // namespace cloth
