#pragma once

#include <Eigen/Core>
#include <vector>

#include "data/core/garment.h"
#include "gnn/physics/energy/block_pattern.h"

namespace cloth {

/// A triangle at rest: Dm is upper triangular in a frame along the first edge, and so is its
/// inverse.
struct RestFace {
    double inverse00, inverse01, inverse11;  ///< of Dm (1/m)
    double area;                             ///< (m^2)

    RestFace(const TriMesh& rest, Eigen::Index face);
};

/// Membrane energy: Saint Venant-Kirchhoff per rest triangle,
///
///     E = A (mu tr(G^2) + lambda / 2 tr(G)^2),   G = (F^T F - I) / 2,   F = Ds Dm^-1 (3 x 2),
///
/// with A the rest area (m^2) and mu, lambda the sheet's constants of Fabric (N/m): the thickness
/// is in them already. Zero at rest, invariant under rigid motion.
class StrainEnergy {
 public:
    /// Keeps a reference to `garment`.
    explicit StrainEnergy(const Garment& garment);

    /// @param x  |V| x 3 (m)
    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;
    /// The same for the faces of one part of several, of equal size.
    double add_gradient(const Points& x, int part, int parts, Points& gradient) const;
    /// Adds the Hessian (N/m) to the values of a matrix of `pattern`. The projection is analytic.
    void add_hessian(const Points& x, const BlockPattern& pattern, HessianKind kind,
                     double* values) const;

 private:
    template <bool with_gradient>
    double accumulate(const double* x, int begin, int end, double* gradient) const;
    int count() const { return static_cast<int>(m_area.size()); }

    const Garment* m_garment;
    std::vector<double> m_inverse00, m_inverse01, m_inverse11, m_area;  ///< see RestFace
};

}  // namespace cloth
