#pragma once

#include <vector>

#include "gnn/physics/energy/lanes.h"
#include "gnn/physics/energy/strain.h"
#include "gnn/physics/solver/crew.h"
#include "gnn/physics/solver/quasi_newton_system.h"

namespace cloth {

/// Hessian of inertia, strain and bending at a point, as a symmetric positive definite matrix in
/// sparse rows of 3 x 3 blocks, one for each free vertex, numbered as in a QuasiNewtonSystem:
///
///     inertia   M / dt^2
///     strain    dS dG + S+ dF dF: stress S without its negative part, since compression has
///               negative curvature
///     bending   that of the flat sheet, the same for all coordinates, and so constant
///
/// Bending is that of Bergou et al. 2006, "A quadratic bending model for inextensible surfaces".
///
/// A crew goes through it together:
///
///     hessian.begin_step(system, dt);
///     crew.for_halves([&](size_t half) { hessian.linearise_faces(half, x); });
///     Crew::wait();
///     ... hessian.linearise_row(row); ...                       // all rows
///     Crew::wait();
///     ... hessian.product(row, direction) ...
///
/// One object serves one crew at a time; after the first step nothing is allocated.
template <class Real>
class FabricHessian {
 public:
    FabricHessian(const Garment& garment, const QuasiNewtonSystem& system);

    /// Whether it was made for such a fabric.
    bool is_of(const Fabric& fabric) const {
        return m_fabric.mu == fabric.mu && m_fabric.lambda == fabric.lambda &&
               m_fabric.bending == fabric.bending;
    }

    /// @param dt  of the inertia (s)
    void begin_step(const QuasiNewtonSystem& system, double dt);
    /// Takes a half of the faces at x (|V| x 3, m).
    void linearise_faces(size_t half, const Points& x);
    /// Adds up a row, once all faces are taken.
    void linearise_row(size_t row);

    /// That row of the matrix times `direction` (n x 4).
    Lanes<Real> product(size_t row, const Real* direction) const;

 private:
    static constexpr size_t numbers = 12;  ///< of a block: three columns of four lanes

    struct Face {
        int corner[3];
        RestFace rest;
        Real gradient[3][2];  ///< of the corners' shape functions (1/m)
    };
    /// What the blocks of a face are made of.
    struct Deformation {
        Lanes<Real> u, v;    ///< columns of F
        Real s00, s01, s11;  ///< tension: stress without its negative part (N/m)
    };
    /// A face at a row's vertex.
    struct Corner {
        int face;
        int first;      ///< of its corners: the row's own; the others follow in turn
        int column[2];  ///< where the blocks of the other two are, from the row's begin; -1: pinned
    };

    void add_faces(const Garment& garment, const std::vector<int>& row_of);
    void add_bending(const Garment& garment, const std::vector<int>& row_of);
    void add_block(const Face& face, const Deformation& at, int i, int j, Real sign,
                   Real* block) const;

    std::vector<Face> m_faces;
    Fabric m_fabric;
    std::vector<Deformation> m_deformations;
    // Strain and bending leave translations alone: a row is sum_j B_ij (d_j - d_i) over the others,
    // so that rounding of stiff blocks is no force on what only moves.
    std::vector<size_t> m_row_begin;  ///< n + 1: in what follows
    std::vector<int> m_column;        ///< of the others, ascending in each row
    std::vector<Real> m_bending;      ///< the same number on the block's diagonal (N/m)
    std::vector<Real> m_blocks;       ///< columns x 12
    std::vector<size_t> m_far_begin;  ///< n + 1: rows that only bending couples
    std::vector<int> m_far_column;
    std::vector<Real> m_far_bending;     ///< (N/m)
    std::vector<size_t> m_corner_begin;  ///< n + 1
    std::vector<Corner> m_corners;
    std::vector<Real> m_own;          ///< n x 12: inertia, and what couples the row to pins
    std::vector<Real> m_own_bending;  ///< n: to pins (N/m)
    std::vector<Real> m_inertia;      ///< n (N/m)
};

}  // namespace cloth
