#pragma once

#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "gnn/physics/solver/affine_correction.h"
#include "gnn/physics/solver/contact_hessian.h"
#include "gnn/physics/solver/deflated_cg.h"
#include "gnn/physics/solver/hessian_cg.h"
#include "gnn/physics/solver/quasi_newton_system.h"

namespace cloth {

/// The constant matrix of the quasi-Newton method, on the free vertices of a garment, factorised:
///
///     P = M / dt^2 + (2 mu + lambda) L,     L: cotangent Laplacian of the rest mesh.
///
/// Arrays called "free" have one row per unpinned vertex (n x 3). One object serves one thread;
/// those of equal garments share the factors.
class QuasiNewtonMatrix {
 public:
    explicit QuasiNewtonMatrix(const Garment& garment);

    /// Chooses P for the garment's masses and fabric and the time step (s) and factorises it,
    /// unless it is among the factors that are kept: those of the last max_factors time steps, so
    /// that a step and its parts take turns at no cost. False: P is not positive definite in double
    /// precision.
    bool prepare(const Garment& garment, double dt);

    static constexpr int max_factors = 16;
    /// So far, those that an equal garment had made already included.
    int factorisations() const { return m_factorisations; }
    /// Constants and factors, which equal garments share.
    const QuasiNewtonSystem& system() const { return *m_system; }

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
    void solve(const Points& b, Points& out) const { m_factors.front()->exact.solve(b, out); }

    /// Until the next `prepare`, solves with contact blocks find the affine displacements of the
    /// vertices at x (|V| x 3, m) directly.
    void deflate(const Points& x);
    /// Takes the displacements of the last deflate() again, if it was of this P. False: it was not.
    bool deflate_as_before();

    /// out = (P + contact blocks)^-1 b (free), by so many conjugate-gradient iterations
    /// preconditioned by P, of soft fabrics in single precision, to which the answer is exact. They
    /// cost as many solves with P, and one more after `deflate`. The blocks anticipate the step
    /// P^-1 b.
    void solve(const Points& b, ContactHessian& contacts, int iterations, Points& out) const;

    /// out = (H + contact blocks)^-1 b (free), H the FabricHessian at x (|V| x 3, m), by so many
    /// conjugate-gradient iterations preconditioned by P.
    void solve(const Garment& garment, const Points& x, const Points& b, ContactHessian& contacts,
               int iterations, Points& out);
    /// Builds what that needs of the garment, ahead of time.
    void prepare_hessian(const Garment& garment);

    const std::vector<int>& row_of() const {
        return m_system->row_of();
    }  ///< |V|: free row, -1 for a pin
    Eigen::Index free_count() const { return static_cast<Eigen::Index>(m_system->free().size()); }
    Eigen::SparseMatrix<double> matrix() const;  ///< P (n x n), both triangles

 private:
    template <class Real>
    struct HessianSolver {
        std::optional<FabricHessian<Real>> hessian;
        HessianCg<Real> cg;

        /// Built anew for another fabric only.
        void prepare(const Garment& garment, const QuasiNewtonSystem& system) {
            if (!hessian || !hessian->is_of(garment.fabric())) hessian.emplace(garment, system);
        }
    };
    template <class Real>
    void solve(const SupernodalCholesky<Real>& factor, HessianSolver<Real>& solver,
               const Garment& garment, const Points& x, const Points& b, ContactHessian& contacts,
               int iterations, Points& out);
    template <class Real>
    void solve(const SupernodalCholesky<Real>& factor, DeflatedCg<Real>& cg, const Points& b,
               ContactHessian& contacts, int iterations, Points& out) const;

    Eigen::Index m_vertex_count;
    std::shared_ptr<QuasiNewtonSystem> m_system;
    /// The one in use first.
    std::list<std::shared_ptr<const QuasiNewtonSystem::Factor>> m_factors;
    int m_factorisations = 0;
    bool m_deflated = false;
    std::weak_ptr<const QuasiNewtonSystem::Factor> m_deflated_factor;  ///< P of m_affine
    mutable AffineCorrection m_affine;
    Points m_points;                      ///< n x 3 (m)
    mutable DeflatedCg<float> m_fast_cg;  ///< of the two, that of the factor in use is
    mutable DeflatedCg<double> m_exact_cg;
    HessianSolver<float> m_fast_hessian;
    HessianSolver<double> m_exact_hessian;
};

}  // namespace cloth
