#pragma once

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>

#include "gnn/physics/solver/affine_fields.h"

namespace cloth {

/// Deflation of the affine displacements of a garment from conjugate gradients for A = P + contact
/// blocks (Saad, Yeung, Erhel and Guyomarc'h 2000, "A deflated version of the conjugate gradient
/// algorithm"): the part of the answer that moves, turns or stretches the garment as a whole is
/// found directly, with twelve unknowns, and every direction stays conjugate to it.
class AffineCorrection {
 public:
    /// Takes the affine fields F of the points x (n x 3, m), and P F for P = stiffness * laplacian
    /// (n x n, both triangles) + rate * masses (n).
    void take(const Points& x, const Eigen::SparseMatrix<double>& laplacian, double stiffness,
              const VectorX& masses, double rate);

    const AffineFields& fields() const { return m_fields; }                 ///< F
    const AffineFields::Columns& p_columns() const { return m_p_columns; }  ///< P F

    /// C' (F' P F) C, summed over the columns of C.
    double energy(const AffineFields::Coefficients& c) const {
        return (m_p * c).cwiseProduct(c).sum();
    }

    /// Factorises F' A F. False: it is not positive definite in double precision.
    /// @param blocks  F' (contact blocks) F
    bool factorise(const AffineFields::System& blocks);

    /// (F' A F)^-1 moments.
    AffineFields::Coefficients coefficients(const AffineFields::Coefficients& moments) const;

 private:
    AffineFields m_fields;
    AffineFields::Columns m_p_columns;  ///< P F
    AffineFields::Weights m_p;          ///< F' P F
    Eigen::LDLT<AffineFields::System> m_factor;
};

}  // namespace cloth
