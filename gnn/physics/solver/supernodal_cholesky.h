#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "data/core/types.h"
#include "gnn/physics/solver/crew.h"

namespace cloth {

/// The unknowns of a sparse symmetric matrix (n x n, both triangles) in an order in which its
/// factor stays sparse: by approximate minimum degree.
std::vector<int> elimination_order(const Eigen::SparseMatrix<double>& matrix);

/// Columns first .. first + width - 1: a dense lower triangle (its diagonal holds reciprocals),
/// then the rows below, both row-major with `width` columns.
struct SupernodalPanel {
    int first, width;
    int row_count;        ///< rows below the triangle
    size_t rows_begin;    ///< in the factor's rows
    size_t values_begin;  ///< in its values
    size_t numbers() const { return size_t(width) * size_t(width + row_count); }
};

/// Cholesky factor of a sparse symmetric positive-definite matrix, made for solving many times with
/// three right-hand sides at once. Columns of equal structure are packed into dense panels of at
/// most eight columns, and the coordinates of a vertex travel together in one vector register. The
/// elimination tree is cut into two halves and a top: what the halves do, two threads do at once
/// (where the matrix is large enough, and OpenMP gives two). The answer has the same bits with one.
/// Of the top, which is small and all but dense, the inverse is kept: the threads share its rows,
/// and none of them waits for another.
///
///     const std::vector<int> order = elimination_order(matrix);  // number the unknowns by it
///     SupernodalCholesky<double> factor;
///     if (factor.factorise(matrix)) factor.solve(b, x);
///
/// Who solves many times in a row keeps the vectors in the factor's own layout, four lanes of Real
/// (x, y, z, 0) a row, and shares out the work on rows as the factor does: see Crew.
///
/// Several threads may solve with one object at once.
///
/// @tparam Real  of the factor and of the solve, which take half the memory and two thirds of the
///               time in float; it is computed in double
template <class Real>
class SupernodalCholesky {
 public:
    SupernodalCholesky() = default;

    /// Factorises (n x n; the lower triangle is read) in the order of the unknowns, which
    /// elimination_order() chooses well. False: not positive definite, and `solve` must not be
    /// called.
    bool factorise(const Eigen::SparseMatrix<double>& matrix);

    /// The factor of another precision, rounded.
    template <class Other>
    explicit SupernodalCholesky(const SupernodalCholesky<Other>& factor)
        : m_size(factor.m_size),
          m_panels(factor.m_panels),
          m_rows(factor.m_rows),
          m_values(factor.m_values.begin(), factor.m_values.end()),
          m_halves(factor.m_halves),
          m_top(factor.m_top),
          m_top_rows(factor.m_top_rows),
          m_top_inverse(factor.m_top_inverse.begin(), factor.m_top_inverse.end()),
          m_part_of(factor.m_part_of) {
        find_rows();
    }

    /// x = A^-1 b for three columns (n x 3); b and x may be the same object.
    void solve(const Points& b, Points& x) const;

    /// Unknowns begin .. end - 1.
    struct Rows {
        int begin, end;
    };
    /// Those of a part (of Crew's), ascending.
    const std::vector<Rows>& rows(size_t part) const { return m_rows_of[part]; }
    /// n: which part each unknown is in.
    const std::vector<unsigned char>& part_of() const { return m_part_of; }
    /// Of the array that a solve in place works on: n, and some to spare.
    size_t work_rows() const { return gathered_begin(1) + m_top_rows.size(); }
    /// work = A^-1 work (work_rows() x 4). All threads of a crew call it: each finds its parts of
    /// b where it put them, and leaves its parts of x.
    void solve(const Crew& crew, Real* work) const;
    /// Threads that a solve is worth: 2, or 1 where the factor is small or OpenMP gives no more.
    int threads() const;

    Eigen::Index size() const { return m_size; }
    size_t nonzeros() const { return m_values.size(); }  ///< stored, with the padding of the panels
    /// Of the numbers that a solve goes through, those of the busier of two threads: 0.5 if the
    /// halves are equal, 1 if nothing can be shared.
    double critical_share() const;

 private:
    template <class>
    friend class SupernodalCholesky;

    void build_panels(const Eigen::SparseMatrix<double>& lower);
    void append_panel(const Eigen::SparseMatrix<double>& lower, int first, int width);
    void cut_in_halves();
    void give_second_half_copies();
    void find_parts();
    void find_rows();
    size_t numbers(const std::vector<int>& panels) const;
    void take(size_t part, const Points& b, Real* work) const;
    void give(size_t part, const Real* work, Points& x) const;
    void invert_top();
    void solve_top(size_t half, Real* work) const;
    void take_top(size_t half, Real* work) const;
    size_t strips() const { return (m_top_rows.size() + strip - 1) / strip; }
    size_t product_begin() const { return static_cast<size_t>(m_size) + m_top_rows.size(); }
    size_t gathered_begin(size_t half) const {
        return product_begin() + strip * strips() + half * m_top_rows.size();
    }
    void eliminate_panels(const std::vector<int>& panels, Real* work) const;
    void substitute_back_panels(const std::vector<int>& panels, Real* work) const;

    static constexpr size_t strip = 8;  ///< rows of the top's inverse that are multiplied together

    Eigen::Index m_size = 0;  ///< n
    std::vector<SupernodalPanel> m_panels;
    std::vector<int> m_rows;  ///< those of the second half that are in the top: of its copies
    std::vector<Real> m_values;
    std::array<std::vector<int>, 2> m_halves;  ///< panels, ascending: no row of one is in the other
    std::vector<int> m_top;                    ///< panels, ascending: ancestors of the halves
    std::vector<int> m_top_rows;      ///< of the top's columns; row k has its copy at m_size + k
    std::vector<Real> m_top_inverse;  ///< strips x |top rows| x 8, the last strip filled with 0
    std::vector<unsigned char> m_part_of;        ///< n
    std::array<std::vector<Rows>, 3> m_rows_of;  ///< each part
};

}  // namespace cloth
