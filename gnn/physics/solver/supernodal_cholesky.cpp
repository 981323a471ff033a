#include "gnn/physics/solver/supernodal_cholesky.h"

#include <Eigen/SparseCholesky>
#include <cstring>
#include <type_traits>

namespace cloth {
namespace {

constexpr int max_width = 8;          // columns of a panel: their y stay in eight vector registers
constexpr double max_padding = 0.25;  // share of explicit zeros that is cheaper than another panel

// x, y, z and a spare lane. Loads and stores go through memcpy: the memory is aligned for one lane.
using FloatLanes = float __attribute__((vector_size(16)));
using DoubleLanes = double __attribute__((vector_size(32)));
template <class Real>
using Lanes = std::conditional_t<std::is_same_v<Real, float>, FloatLanes, DoubleLanes>;

template <class Real>
inline Lanes<Real> load(const Real* p) {
    Lanes<Real> v;
    std::memcpy(&v, p, sizeof(v));
    return v;
}

template <class Real>
inline void store(Real* p, const Lanes<Real>& v) {
    std::memcpy(p, &v, sizeof(v));
}

// y = T^-1 y within the panel's columns, then work[row] -= B y for the rows below.
template <class Real, int W>
void eliminate(const Real* values, const int* rows, int row_count, Real* own, Real* work) {
    Lanes<Real> y[W];
    for (int c = 0; c < W; ++c) y[c] = load(own + 4 * c);
    for (int r = 0; r < W; ++r, values += W) {
        for (int c = 0; c < r; ++c) y[r] -= values[c] * y[c];
        y[r] *= values[r];
        store<Real>(own + 4 * r, y[r]);
    }
    for (int i = 0; i < row_count; ++i, values += W) {
        Real* target = work + 4 * static_cast<size_t>(rows[i]);
        Lanes<Real> sum = load(target);
        for (int c = 0; c < W; ++c) sum -= values[c] * y[c];
        store<Real>(target, sum);
    }
}

// y = T^-T (y - B^T work[rows]).
template <class Real, int W>
void substitute_back(const Real* values, const int* rows, int row_count, Real* own,
                     const Real* work) {
    Lanes<Real> y[W];
    for (int c = 0; c < W; ++c) y[c] = load(own + 4 * c);
    const Real* below = values + W * W;
    for (int i = 0; i < row_count; ++i, below += W) {
        const Lanes<Real> known = load(work + 4 * static_cast<size_t>(rows[i]));
        for (int c = 0; c < W; ++c) y[c] -= below[c] * known;
    }
    for (int r = W - 1; r >= 0; --r) {
        const Real* row = values + W * r;
        y[r] *= row[r];
        store<Real>(own + 4 * r, y[r]);
        for (int c = 0; c < r; ++c) y[c] -= row[c] * y[r];
    }
}

template <class Real>
struct OfWidth {
    using Eliminate = void (*)(const Real*, const int*, int, Real*, Real*);
    using SubstituteBack = void (*)(const Real*, const int*, int, Real*, const Real*);
    static constexpr Eliminate eliminate[] = {cloth::eliminate<Real, 1>, cloth::eliminate<Real, 2>,
                                              cloth::eliminate<Real, 3>, cloth::eliminate<Real, 4>,
                                              cloth::eliminate<Real, 5>, cloth::eliminate<Real, 6>,
                                              cloth::eliminate<Real, 7>, cloth::eliminate<Real, 8>};
    static constexpr SubstituteBack substitute_back[] = {
        cloth::substitute_back<Real, 1>, cloth::substitute_back<Real, 2>,
        cloth::substitute_back<Real, 3>, cloth::substitute_back<Real, 4>,
        cloth::substitute_back<Real, 5>, cloth::substitute_back<Real, 6>,
        cloth::substitute_back<Real, 7>, cloth::substitute_back<Real, 8>};
};

int column_count(const Eigen::SparseMatrix<double>& lower, int column) {
    return lower.outerIndexPtr()[column + 1] - lower.outerIndexPtr()[column];
}

// Whether `column` is the parent of the column before it in the elimination tree: then the earlier
// column's rows are among the later one's, and both fit one panel.
bool continues(const Eigen::SparseMatrix<double>& lower, int column) {
    const int previous = column - 1;
    return column_count(lower, previous) > 1 &&
           lower.innerIndexPtr()[lower.outerIndexPtr()[previous] + 1] == column;
}

// Widest panel that starts at `first` and stays within the allowed padding.
int panel_width(const Eigen::SparseMatrix<double>& lower, int first) {
    const int columns = static_cast<int>(lower.cols());
    int width = 1;
    int stored = column_count(lower, first);
    for (int column = first + 1; column < columns && width < max_width; ++column) {
        if (!continues(lower, column)) break;
        stored += column_count(lower, column);
        const int candidate = column - first + 1;
        const int below = column_count(lower, column) - 1;
        const int dense = candidate * (candidate + 1) / 2 + candidate * below;
        if (dense - stored > max_padding * dense) break;
        width = candidate;
    }
    return width;
}

}  // namespace

std::vector<int> elimination_order(const Eigen::SparseMatrix<double>& matrix) {
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(matrix, permutation);
    const auto& order = permutation.indices();
    return {order.data(), order.data() + order.size()};
}

template <class Real>
bool SupernodalCholesky<Real>::factorise(const Eigen::SparseMatrix<double>& matrix) {
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
        cholesky(matrix);
    if (cholesky.info() != Eigen::Success) return false;
    m_size = matrix.rows();
    build_panels(Eigen::SparseMatrix<double>(cholesky.matrixL()));
    return true;
}

template <class Real>
void SupernodalCholesky<Real>::build_panels(const Eigen::SparseMatrix<double>& lower) {
    m_panels.clear();
    m_rows.clear();
    m_values.clear();
    const int columns = static_cast<int>(lower.cols());
    for (int first = 0; first < columns; first += m_panels.back().width)
        append_panel(lower, first, panel_width(lower, first));
}

template <class Real>
void SupernodalCholesky<Real>::append_panel(const Eigen::SparseMatrix<double>& lower, int first,
                                            int width) {
    const int last = first + width - 1;
    const int* begin = lower.innerIndexPtr() + lower.outerIndexPtr()[last] + 1;
    const int row_count = column_count(lower, last) - 1;
    m_panels.push_back({first, width, row_count, m_rows.size(), m_values.size()});
    m_rows.insert(m_rows.end(), begin, begin + row_count);
    m_values.resize(m_values.size() + static_cast<size_t>(width) * (width + row_count), Real(0));
    Real* values = m_values.data() + m_panels.back().values_begin;
    for (int c = 0; c < width; ++c) {
        int below = 0;
        for (Eigen::SparseMatrix<double>::InnerIterator it(lower, first + c); it; ++it) {
            const int row = static_cast<int>(it.row());
            int place = row - first;
            if (row > last) {
                while (begin[below] != row) ++below;
                place = width + below;
            }
            values[place * width + c] =
                static_cast<Real>(row == first + c ? 1.0 / it.value() : it.value());
        }
    }
}

template <class Real>
void SupernodalCholesky<Real>::solve(const Points& b, Points& x) const {
    static thread_local std::vector<Real> lanes;  // x, y, z, and 0 for ever
    const auto count = static_cast<size_t>(m_size);
    if (lanes.size() < 4 * count) lanes.resize(4 * count, Real(0));
    Real* work = lanes.data();
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < 3; ++k) work[4 * i + k] = static_cast<Real>(b.data()[3 * i + k]);
    for (const SupernodalPanel& panel : m_panels)
        OfWidth<Real>::eliminate[panel.width - 1](m_values.data() + panel.values_begin,
                                                  m_rows.data() + panel.rows_begin, panel.row_count,
                                                  work + 4 * panel.first, work);
    for (auto panel = m_panels.rbegin(); panel != m_panels.rend(); ++panel)
        OfWidth<Real>::substitute_back[panel->width - 1](
            m_values.data() + panel->values_begin, m_rows.data() + panel->rows_begin,
            panel->row_count, work + 4 * panel->first, work);
    x.resize(b.rows(), 3);
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < 3; ++k) x.data()[3 * i + k] = double(work[4 * i + k]);
}

template class SupernodalCholesky<float>;
template class SupernodalCholesky<double>;

}  // namespace cloth
