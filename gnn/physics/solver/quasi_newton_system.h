#pragma once

#include <Eigen/SparseCore>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "data/core/garment.h"
#include "gnn/physics/solver/supernodal_cholesky.h"

namespace cloth {

/// Cotangent Laplacian (|V| x |V|, no unit, positive semi-definite): x' L x is the Dirichlet energy
/// times two. Pinkall and Polthier 1993, equation 7.
Eigen::SparseMatrix<double> cotangent_laplacian(const TriMesh& rest);

/// The constants of a QuasiNewtonMatrix, and its factors. Equal garments share one: as many
/// characters in the same shirt as there are cost one factorisation for each time step.
///
///     const auto system = QuasiNewtonSystem::of(garment);
///     const auto factor = system->factor(1.0 / 30.0);
///
/// All functions may be called from several threads at once.
class QuasiNewtonSystem {
 public:
    /// P of one time step.
    struct Factor {
        double dt;  ///< (s)
        SupernodalCholesky<double> exact;
        SupernodalCholesky<float>
            fast;  ///< as a preconditioner; empty where it is not exact enough
    };

    /// That of a garment with the same rest shape, pins and fabric, to the bit, if there is one
    /// somewhere.
    static std::shared_ptr<QuasiNewtonSystem> of(const Garment& garment);

    explicit QuasiNewtonSystem(const Garment& garment);

    bool is_of(const Garment& garment) const;
    bool is_of(const Fabric& fabric) const;
    /// Factorises P unless somebody has this factor. Null: P is not positive definite in double
    /// precision.
    std::shared_ptr<const Factor> factor(double dt);
    Eigen::SparseMatrix<double> matrix(double dt) const;  ///< P (n x n), both triangles

    const Fabric& fabric() const { return m_fabric; }
    const std::vector<int>& pins() const { return m_pins; }
    const std::vector<int>& free() const { return m_free; }      ///< n: vertex of each free row
    const std::vector<int>& row_of() const { return m_row_of; }  ///< |V|: free row, -1 for a pin
    const Eigen::SparseMatrix<double>& laplacian() const { return m_laplacian; }  ///< n x n
    const VectorX& masses() const { return m_masses; }                            ///< n (kg)

 private:
    void number_free_vertices(const Garment& garment, const Eigen::SparseMatrix<double>& laplacian);

    TriMesh m_rest;
    Fabric m_fabric;
    std::vector<int> m_pins;
    std::vector<int> m_free;
    std::vector<int> m_row_of;
    Eigen::SparseMatrix<double> m_laplacian;
    VectorX m_masses;
    std::mutex m_mutex;  ///< of the factors
    std::map<double, std::weak_ptr<const Factor>> m_factors;
};

}  // namespace cloth
