#pragma once

#include <vector>

#include "gnn/physics/incremental_potential.h"
#include "gnn/physics/supernodal_cholesky.h"

namespace cloth {

/// Cotangent Laplacian (|V| x |V|, no unit, positive semi-definite): x' L x is the Dirichlet energy
/// times two. Pinkall and Polthier 1993, equation 7.
Eigen::SparseMatrix<double> cotangent_laplacian(const TriMesh& rest);

/// The constant matrix of the quasi-Newton method, on the free vertices of a garment,
///
///     P = M / dt^2 + (2 mu + lambda) L,     L: cotangent Laplacian of the rest mesh,
///
/// factorised, and on top of it, where vertices touch obstacles, the contact Hessian
/// 6 w (eps - d) n n' of those vertices, which changes with x and is met by conjugate gradients.
/// Arrays called "free" have one row per unpinned vertex (n x 3). One object serves one thread.
class QuasiNewtonMatrix {
 public:
    explicit QuasiNewtonMatrix(const Garment& garment);

    /// Factorises P for the garment's masses and fabric and the time step (s), unless that is what
    /// it holds. False: P is not positive definite in double precision.
    bool prepare(const Garment& garment, double dt);

    /// Whether a garment has the vertices and pins that this matrix was made for.
    bool fits(const Garment& garment) const;

    void gather(const Points& all, Points& free) const;
    /// Rows of pinned vertices are set to zero.
    void scatter(const Points& free, Points& all) const;
    /// all += scale * free, at the free vertices.
    void add_scaled(double scale, const Points& free, Points& all) const;

    /// out = P^-1 b (free).
    void solve(const Points& b, Points& out) const { m_factor.solve(b, out); }

    /// Takes the contact Hessian at x (|V| x 3). Returns whether any free vertex is in contact.
    bool set_contacts(const IncrementalPotential& potential, const Points& x);

    /// out = (P + contact Hessian)^-1 b (free), by so many conjugate-gradient iterations, each of
    /// which costs one solve with P.
    void solve_with_contacts(const Points& b, int iterations, Points& out);

    Eigen::Index free_count() const { return static_cast<Eigen::Index>(m_free.size()); }
    Eigen::SparseMatrix<double> matrix() const { return m_matrix; }  ///< P (n x n), both triangles

 private:
    struct Contact {
        int row;           ///< free row
        double stiffness;  ///< 6 w (eps - d) (N/m)
        Vec3 normal;
    };
    void add_contact_product(const Points& direction, Points& product) const;

    Eigen::Index m_vertex_count;
    std::vector<int> m_pins;
    std::vector<int> m_free;                  ///< vertex of each free row
    Eigen::SparseMatrix<double> m_laplacian;  ///< free rows and columns
    Eigen::SparseMatrix<double> m_matrix;
    Fabric m_fabric;
    double m_dt = 0.0;  ///< 0: nothing factorised yet
    SupernodalCholesky m_factor;
    std::vector<Contact> m_contacts;
    Points m_residual, m_preconditioned, m_direction, m_product, m_p_direction;  ///< n x 3
};

}  // namespace cloth
