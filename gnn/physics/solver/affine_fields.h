#pragma once

#include "data/core/types.h"

namespace cloth {

/// The affine displacements of n points,
///
///     u = F C,     F = (1, y1, y2, y3)  (n x 4),     C: 4 x 3,
///
/// with y the points' principal coordinates, centred and scaled to unit variance, so that the space
/// of displacements turns and moves with the points. Coordinates along which the points do not
/// extend are left out: their column is zero.
class AffineFields {
 public:
    static constexpr int count = 4;
    using Row = Eigen::Matrix<double, count, 1>;
    using Coefficients = Eigen::Matrix<double, count, 3, Eigen::RowMajor>;
    using Columns = Eigen::Matrix<double, Eigen::Dynamic, count, Eigen::RowMajor>;
    using Vector = Eigen::Matrix<double, 3 * count, 1>;          ///< the coefficients, row by row
    using System = Eigen::Matrix<double, 3 * count, 3 * count>;  ///< symmetric, of such vectors
    using Weights = Eigen::Matrix<double, count, count>;         ///< symmetric, of the fields

    /// Of the points x (n x 3).
    void take(const Points& x);

    const Columns& columns() const { return m_columns; }  ///< F
    Row at(Eigen::Index point) const { return m_columns.row(point).transpose(); }

    /// F' a, for a of n x 3.
    Coefficients moments(const Points& a) const;

    /// system += weights for what the fields in direction `column` do to those in direction `row`.
    static void add(const Weights& weights, int row, int column, System& system);
    /// The same for each of the three directions with itself.
    static void add_isotropic(const Weights& weights, System& system);

 private:
    Columns m_columns;
};

}  // namespace cloth
