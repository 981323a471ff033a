#pragma once

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>

#include "gnn/physics/solver/affine_fields.h"
#include "gnn/physics/solver/contact_hessian.h"

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

    /// Factorises F' A F. False: it is not positive definite in double precision.
    bool factorise(const ContactHessian& contacts);

    /// x = F (F' A F)^-1 F' b, p_x = P x.
    void solve(const Points& b, Points& x, Points& p_x) const;

    /// direction = z + beta direction - F c, and P times that, with c so that A times the new
    /// direction has no affine part. The direction before has none, nor has the residual.
    /// @param z         P^-1 residual
    void add_conjugate(const ContactHessian& contacts, const Points& z, const Points& residual,
                       double beta, Points& direction, Points& p_direction) const;

 private:
    AffineFields::Coefficients coefficients(const AffineFields::Coefficients& moments) const;

    AffineFields m_fields;
    AffineFields::Columns m_p_columns;  ///< P F
    AffineFields::Weights m_p;          ///< F' P F
    Eigen::LDLT<AffineFields::System> m_factor;
};

}  // namespace cloth
