#pragma once

#include <vector>

#include "data/core/garment.h"
#include "gnn/physics/energy/block_pattern.h"

namespace cloth {

/// Factor of (theta - theta_rest)^2 / 2 in a hinge's energy: k l^2 / (4 (A0 + A1)) (J).
double hinge_stiffness(const Garment& garment, const Hinge& hinge);

/// Bending energy: quadratic in the dihedral angle of every interior edge,
///
///     E = k l^2 / (4 (A0 + A1)) (theta - theta_rest)^2 / 2,
///
/// with k the bending stiffness (N m), l the rest length (m) of the edge and A0, A1 the rest areas
/// (m^2) of its faces (Grinspun et al. 2003; Tamstorf and Grinspun 2013). HOOD takes the current
/// length for l, which adds a force that pulls bent edges short although bending has nothing to do
/// with the edge's length; the rest length keeps the factor constant. The difference of angles is
/// taken in (-pi, pi]. Where a face has collapsed, the gradient is bounded, not exact.
class BendingEnergy {
 public:
    /// Keeps a reference to `garment`.
    explicit BendingEnergy(const Garment& garment);

    /// @param x  |V| x 3 (m)
    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;
    /// The same for the hinges of one part of several, of equal size.
    double add_gradient(const Points& x, int part, int parts, Points& gradient) const;
    /// Adds the Hessian (N/m) to the values of a matrix of `pattern`. Projected means Gauss-Newton:
    /// the part with the second derivative of the angle is left out.
    void add_hessian(const Points& x, const BlockPattern& pattern, HessianKind kind,
                     double* values) const;

 private:
    template <bool with_gradient>
    double accumulate(const double* x, int begin, int end, double* gradient) const;
    int count() const { return static_cast<int>(m_stiffness.size()); }

    const Garment* m_garment;
    std::vector<double> m_stiffness;  ///< k l^2 / (4 (A0 + A1)) (J)
    double m_min_normal = 0.0;  ///< squared area vectors below this are a collapsed face (m^4)
    double m_min_edge = 0.0;    ///< squared lengths below this are a collapsed edge (m^2)
};

}  // namespace cloth
