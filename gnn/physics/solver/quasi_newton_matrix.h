#pragma once

#include <list>
#include <vector>

#include "gnn/physics/solver/affine_correction.h"
#include "gnn/physics/solver/contact_hessian.h"
#include "gnn/physics/solver/supernodal_cholesky.h"

namespace cloth {

/// Cotangent Laplacian (|V| x |V|, no unit, positive semi-definite): x' L x is the Dirichlet energy
/// times two. Pinkall and Polthier 1993, equation 7.
Eigen::SparseMatrix<double> cotangent_laplacian(const TriMesh& rest);

/// The constant matrix of the quasi-Newton method, on the free vertices of a garment, factorised:
///
///     P = M / dt^2 + (2 mu + lambda) L,     L: cotangent Laplacian of the rest mesh.
///
/// Arrays called "free" have one row per unpinned vertex (n x 3). One object serves one thread.
class QuasiNewtonMatrix {
 public:
    explicit QuasiNewtonMatrix(const Garment& garment);

    /// Chooses P for the garment's masses and fabric and the time step (s) and factorises it,
    /// unless it is among the factors that are kept: those of the last max_factors time steps, so
    /// that a step and its parts take turns at no cost. False: P is not positive definite in double
    /// precision.
    bool prepare(const Garment& garment, double dt);

    static constexpr int max_factors = 16;
    int factorisations() const { return m_factorisations; }  ///< so far

    /// Whether a garment has the vertices and pins that this matrix was made for.
    bool fits(const Garment& garment) const;

    void gather(const Points& all, Points& free) const;
    /// free = the free rows of a - b.
    void gather_difference(const Points& a, const Points& b, Points& free) const;
    /// Rows of pinned vertices are set to zero.
    void scatter(const Points& free, Points& all) const;
    /// all += scale * free, at the free vertices.
    void add_scaled(double scale, const Points& free, Points& all) const;

    /// out = P^-1 b (free).
    void solve(const Points& b, Points& out) const { m_factors.front().exact.solve(b, out); }

    /// Until the next `prepare`, solves with contact blocks find the affine displacements of the
    /// vertices at x (|V| x 3, m) directly.
    void deflate(const Points& x);

    /// out = (P + contact blocks)^-1 b (free), by so many conjugate-gradient iterations
    /// preconditioned by P, of soft fabrics in single precision, to which the answer is exact. They
    /// cost as many solves with P, and one more after `deflate`. The blocks anticipate the step
    /// P^-1 b.
    void solve(const Points& b, ContactHessian& contacts, int iterations, Points& out) const;

    const std::vector<int>& row_of() const { return m_row_of; }  ///< |V|: free row, -1 for a pin
    Eigen::Index free_count() const { return static_cast<Eigen::Index>(m_free.size()); }
    Eigen::SparseMatrix<double> matrix() const;  ///< P (n x n), both triangles

 private:
    struct Factor {
        double dt;  ///< (s)
        SupernodalCholesky<double> exact;
        SupernodalCholesky<float>
            fast;  ///< as a preconditioner; empty where it is not exact enough

        bool factorise(const Eigen::SparseMatrix<double>& matrix, double mean_inertia);
    };
    /// out = P^-1 b, to single precision where that suffices.
    void precondition(const Points& b, Points& out) const;
    void number_free_vertices(const Garment& garment, const Eigen::SparseMatrix<double>& laplacian);
    Eigen::SparseMatrix<double> assembled(double dt) const;

    Eigen::Index m_vertex_count;
    std::vector<int> m_pins;
    std::vector<int> m_free;                  ///< vertex of each free row
    std::vector<int> m_row_of;                ///< |V|
    Eigen::SparseMatrix<double> m_laplacian;  ///< free rows and columns
    VectorX m_masses;                         ///< free rows
    Fabric m_fabric;                          ///< of the factors
    std::list<Factor> m_factors;              ///< the one in use first
    int m_factorisations = 0;
    bool m_deflated = false;
    mutable AffineCorrection m_affine;
    Points m_points;  ///< n x 3 (m)
    mutable Points m_residual, m_preconditioned, m_direction, m_product, m_p_direction;  ///< n x 3
};

}  // namespace cloth
