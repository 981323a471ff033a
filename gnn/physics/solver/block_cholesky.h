#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// Cholesky factorisation of a sparse symmetric matrix of 3 x 3 blocks (3n x 3n, both triangles, as
/// BlockPattern makes them), for matrices whose values change and whose sparsity does not: order
/// and structure are found once. Multifrontal: columns of equal structure form dense fronts, which
/// Eigen's dense kernels factorise; independent subtrees run in parallel (Duff and Reid 1983; Liu
/// 1992). The same bits for any number of threads.
///
///     BlockCholesky cholesky;
///     cholesky.analyse(matrix);
///     if (cholesky.factorise(matrix)) cholesky.solve(x);
class BlockCholesky {
 public:
    /// Finds a fill-reducing order and the structure of the factor.
    void analyse(const Eigen::SparseMatrix<double>& matrix);

    /// Whether analyse() has seen a matrix of this size and number of nonzeros.
    bool is_analysed_for(const Eigen::SparseMatrix<double>& matrix) const;

    /// Factorises matrix + shift * I. False: it is not positive definite, and the factor is
    /// unusable.
    bool factorise(const Eigen::SparseMatrix<double>& matrix, double shift = 0.0);

    /// Replaces b (3n) by the solution.
    void solve(VectorX& b) const;

    size_t nonzeros() const { return m_values.size(); }  ///< stored numbers, padding included

 private:
    /// Block columns first .. first + width - 1 of the elimination order, eliminated together. Its
    /// panel in m_values is (3 (width + rows) x 3 width), column-major: the triangle, then below.
    struct Front {
        int first, width;
        int parent;                  ///< front, -1: none
        std::vector<int> rows;       ///< block rows below the triangle, ascending
        std::vector<int> in_parent;  ///< their places among the parent's columns and rows
        std::vector<int> children;
        size_t values_begin;  ///< in m_values
        double subtree_work;  ///< multiplications of the front and all below it
        int height() const { return 3 * (width + static_cast<int>(rows.size())); }
    };
    /// A block of the matrix and its place in its front's panel.
    struct Entry {
        int source, stride;  ///< in the matrix's values
        int row, column;     ///< block coordinates in the panel
    };

    void build_fronts(const std::vector<std::vector<int>>& structure);
    void link_fronts();
    void place_entries(const Eigen::SparseMatrix<double>& matrix);
    bool factorise_subtree(int front, const double* source, double shift);
    bool factorise_front(int front, const double* source, double shift);
    void take_update(int child, Eigen::Map<Eigen::MatrixXd>& panel,
                     Eigen::Map<Eigen::MatrixXd>& update);
    void eliminate(const Front& front, VectorX& y) const;
    void substitute(const Front& front, VectorX& y) const;

    size_t m_source_nonzeros = 0;
    std::vector<int> m_position;  ///< n: place of each block in the elimination order
    std::vector<Front> m_fronts;  ///< children before parents
    std::vector<int> m_roots;
    std::vector<std::vector<Entry>> m_entries;   ///< per front
    std::vector<double> m_values;                ///< the factor
    std::vector<std::vector<double>> m_updates;  ///< per front, alive until its parent takes it
};

}  // namespace cloth
