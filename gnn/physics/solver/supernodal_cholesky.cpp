#include "gnn/physics/solver/supernodal_cholesky.h"

#include <Eigen/SparseCholesky>
#include <cstring>

namespace cloth {
namespace {

constexpr int max_width = 8;          // columns of a panel: their y stay in eight vector registers
constexpr double max_padding = 0.25;  // share of explicit zeros that is cheaper than another panel

// x, y, z and a spare lane. Loads and stores go through memcpy: the memory is only 8-aligned.
using Lanes = double __attribute__((vector_size(32)));

inline Lanes load(const double* p) {
    Lanes v;
    std::memcpy(&v, p, sizeof(v));
    return v;
}

inline void store(double* p, const Lanes& v) {
    std::memcpy(p, &v, sizeof(v));
}

// y = T^-1 y within the panel's columns, then work[row] -= B y for the rows below.
template <int W>
void eliminate(const double* values, const int* rows, int row_count, double* own, double* work) {
    Lanes y[W];
    for (int c = 0; c < W; ++c) y[c] = load(own + 4 * c);
    for (int r = 0; r < W; ++r, values += W) {
        for (int c = 0; c < r; ++c) y[r] -= values[c] * y[c];
        y[r] *= values[r];
        store(own + 4 * r, y[r]);
    }
    for (int i = 0; i < row_count; ++i, values += W) {
        double* target = work + 4 * static_cast<size_t>(rows[i]);
        Lanes sum = load(target);
        for (int c = 0; c < W; ++c) sum -= values[c] * y[c];
        store(target, sum);
    }
}

// y = T^-T (y - B^T work[rows]).
template <int W>
void substitute_back(const double* values, const int* rows, int row_count, double* own,
                     const double* work) {
    Lanes y[W];
    for (int c = 0; c < W; ++c) y[c] = load(own + 4 * c);
    const double* below = values + W * W;
    for (int i = 0; i < row_count; ++i, below += W) {
        const Lanes known = load(work + 4 * static_cast<size_t>(rows[i]));
        for (int c = 0; c < W; ++c) y[c] -= below[c] * known;
    }
    for (int r = W - 1; r >= 0; --r) {
        const double* row = values + W * r;
        y[r] *= row[r];
        store(own + 4 * r, y[r]);
        for (int c = 0; c < r; ++c) y[c] -= row[c] * y[r];
    }
}

using Eliminate = void (*)(const double*, const int*, int, double*, double*);
using SubstituteBack = void (*)(const double*, const int*, int, double*, const double*);
constexpr Eliminate eliminate_of_width[] = {eliminate<1>, eliminate<2>, eliminate<3>, eliminate<4>,
                                            eliminate<5>, eliminate<6>, eliminate<7>, eliminate<8>};
constexpr SubstituteBack substitute_back_of_width[] = {
    substitute_back<1>, substitute_back<2>, substitute_back<3>, substitute_back<4>,
    substitute_back<5>, substitute_back<6>, substitute_back<7>, substitute_back<8>};

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

bool SupernodalCholesky::factorise(const Eigen::SparseMatrix<double>& matrix) {
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> cholesky(matrix);
    if (cholesky.info() != Eigen::Success) return false;
    const auto& order = cholesky.permutationP().indices();
    m_position.assign(order.data(), order.data() + order.size());
    build_panels(Eigen::SparseMatrix<double>(cholesky.matrixL()));
    m_work.assign(4 * m_position.size(), 0.0);
    return true;
}

void SupernodalCholesky::build_panels(const Eigen::SparseMatrix<double>& lower) {
    m_panels.clear();
    m_rows.clear();
    m_values.clear();
    const int columns = static_cast<int>(lower.cols());
    for (int first = 0; first < columns; first += m_panels.back().width)
        append_panel(lower, first, panel_width(lower, first));
}

void SupernodalCholesky::append_panel(const Eigen::SparseMatrix<double>& lower, int first,
                                      int width) {
    const int last = first + width - 1;
    const int* begin = lower.innerIndexPtr() + lower.outerIndexPtr()[last] + 1;
    const int row_count = column_count(lower, last) - 1;
    m_panels.push_back({first, width, row_count, m_rows.size(), m_values.size()});
    m_rows.insert(m_rows.end(), begin, begin + row_count);
    m_values.resize(m_values.size() + static_cast<size_t>(width) * (width + row_count), 0.0);
    double* values = m_values.data() + m_panels.back().values_begin;
    for (int c = 0; c < width; ++c) {
        int below = 0;
        for (Eigen::SparseMatrix<double>::InnerIterator it(lower, first + c); it; ++it) {
            const int row = static_cast<int>(it.row());
            int place = row - first;
            if (row > last) {
                while (begin[below] != row) ++below;
                place = width + below;
            }
            values[place * width + c] = row == first + c ? 1.0 / it.value() : it.value();
        }
    }
}

void SupernodalCholesky::solve(const Points& b, Points& x) const {
    double* work = m_work.data();
    for (size_t i = 0; i < m_position.size(); ++i)
        std::memcpy(work + 4 * m_position[i], b.data() + 3 * i, 3 * sizeof(double));
    for (const Panel& panel : m_panels)
        eliminate_of_width[panel.width - 1](m_values.data() + panel.values_begin,
                                            m_rows.data() + panel.rows_begin, panel.row_count,
                                            work + 4 * panel.first, work);
    for (auto panel = m_panels.rbegin(); panel != m_panels.rend(); ++panel)
        substitute_back_of_width[panel->width - 1](m_values.data() + panel->values_begin,
                                                   m_rows.data() + panel->rows_begin,
                                                   panel->row_count, work + 4 * panel->first, work);
    x.resize(b.rows(), 3);
    for (size_t i = 0; i < m_position.size(); ++i)
        std::memcpy(x.data() + 3 * i, work + 4 * m_position[i], 3 * sizeof(double));
}

}  // namespace cloth
