#include "gnn/physics/solver/supernodal_cholesky.h"

#include <omp.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <limits>
#include <numeric>
#include <type_traits>
#include <utility>

#include "gnn/physics/energy/lanes.h"

namespace cloth {
namespace {

constexpr int max_width = 8;          // columns of a panel: their y stay in eight vector registers
constexpr double max_padding = 0.25;  // share of explicit zeros that is cheaper than another panel
constexpr size_t enough_numbers = 60000;  // of a factor, to be worth waking a second thread for

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

// x = strip of an inverse * b.
template <class Real, size_t rows>
void multiply(const Real* strip, const Real* b, size_t count, Real* x) {
    Lanes<Real> sums[rows];
    for (size_t i = 0; i < rows; ++i) sums[i] = Lanes<Real>{};
    for (size_t k = 0; k < count; ++k, strip += rows) {
        const Lanes<Real> known = load(b + 4 * k);
        for (size_t i = 0; i < rows; ++i) sums[i] += strip[i] * known;
    }
    for (size_t i = 0; i < rows; ++i) store<Real>(x + 4 * i, sums[i]);
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

/// Trees that are shared out between two, the heaviest first, each to whom has less so far.
struct Shares {
    std::vector<char> of;  ///< each tree: 0 or 1
    size_t larger = 0;

    Shares(const std::vector<int>& trees, const std::vector<size_t>& weights) : of(trees.size()) {
        std::vector<size_t> order(trees.size());
        std::iota(order.begin(), order.end(), size_t(0));
        const auto weight = [&](size_t k) { return weights[static_cast<size_t>(trees[k])]; };
        std::stable_sort(order.begin(), order.end(),
                         [&](size_t a, size_t b) { return weight(a) > weight(b); });
        size_t sums[2] = {0, 0};
        for (const size_t k : order) {
            of[k] = sums[1] < sums[0] ? 1 : 0;
            sums[static_cast<size_t>(of[k])] += weight(k);
        }
        larger = std::max(sums[0], sums[1]);
    }
};

}  // namespace

std::vector<int> elimination_order(const Eigen::SparseMatrix<double>& matrix) {
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(matrix, permutation);
    const auto& order = permutation.indices();
    return {order.data(), order.data() + order.size()};
}

template <class Real>
bool SupernodalCholesky<Real>::factorise(const Eigen::SparseMatrix<double>& matrix) {
    if constexpr (std::is_same_v<Real, double>) {
        Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
            cholesky(matrix);
        if (cholesky.info() != Eigen::Success) return false;
        m_size = matrix.rows();
        build_panels(Eigen::SparseMatrix<double>(cholesky.matrixL()));
    } else {
        SupernodalCholesky<double> exact;
        if (!exact.factorise(matrix)) return false;
        *this = SupernodalCholesky(exact);
    }
    return true;
}

template <class Real>
void SupernodalCholesky<Real>::build_panels(const Eigen::SparseMatrix<double>& lower) {
    m_panels.clear();
    m_rows.clear();
    m_values.clear();
    for (std::vector<int>* part : {&m_halves[0], &m_halves[1], &m_top, &m_top_rows}) part->clear();
    const int columns = static_cast<int>(lower.cols());
    for (int first = 0; first < columns; first += m_panels.back().width)
        append_panel(lower, first, panel_width(lower, first));
    cut_in_halves();
    give_second_half_copies();
    find_parts();
    find_rows();
    invert_top();
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

/// Opens the heaviest subtree of the elimination tree, again and again, which adds its root to the
/// top, and keeps the cut for which the top and the larger half are least.
template <class Real>
void SupernodalCholesky<Real>::cut_in_halves() {
    constexpr int most_cuts = 200;
    const size_t count = m_panels.size();
    std::vector<int> panel_of(static_cast<size_t>(m_size)), parent(count, -1), open;
    std::vector<std::vector<int>> children(count);
    std::vector<size_t> weights(count, 0);
    for (size_t p = 0; p < count; ++p)
        std::fill_n(panel_of.begin() + m_panels[p].first, m_panels[p].width, static_cast<int>(p));
    for (size_t p = 0; p < count; ++p) {  // children come before their parents
        weights[p] += m_panels[p].numbers();
        if (m_panels[p].row_count > 0)
            parent[p] = panel_of[static_cast<size_t>(m_rows[m_panels[p].rows_begin])];
        auto& siblings = parent[p] < 0 ? open : children[static_cast<size_t>(parent[p])];
        siblings.push_back(static_cast<int>(p));
        if (parent[p] >= 0) weights[static_cast<size_t>(parent[p])] += weights[p];
    }

    constexpr char in_top = 2;
    std::vector<char> place;  // of the roots of subtrees
    size_t top_weight = 0, least = std::numeric_limits<size_t>::max();
    for (int cut = 0; cut < most_cuts && !open.empty(); ++cut) {
        const Shares shares(open, weights);
        if (top_weight + shares.larger < least) {
            least = top_weight + shares.larger;
            place.assign(count, in_top);
            for (size_t k = 0; k < open.size(); ++k)
                place[static_cast<size_t>(open[k])] = shares.of[k];
        }
        const auto heaviest = std::max_element(open.begin(), open.end(), [&](int a, int b) {
            return weights[static_cast<size_t>(a)] < weights[static_cast<size_t>(b)];
        });
        const int root = *heaviest;
        open.erase(heaviest);
        top_weight += m_panels[static_cast<size_t>(root)].numbers();
        const auto& below = children[static_cast<size_t>(root)];
        open.insert(open.end(), below.begin(), below.end());
    }
    for (size_t p = count; p-- > 0;)
        if (parent[p] >= 0 && place[static_cast<size_t>(parent[p])] != in_top)
            place[p] = place[static_cast<size_t>(parent[p])];
    for (size_t p = 0; p < count; ++p) {
        auto& panels = place[p] == in_top ? m_top : m_halves[static_cast<size_t>(place[p])];
        panels.push_back(static_cast<int>(p));
    }
}

/// Both halves subtract from the rows of the top: the second does so from copies.
template <class Real>
void SupernodalCholesky<Real>::give_second_half_copies() {
    std::vector<int> copy(static_cast<size_t>(m_size), -1);
    for (const int p : m_top)
        for (int c = 0; c < m_panels[static_cast<size_t>(p)].width; ++c) {
            const int row = m_panels[static_cast<size_t>(p)].first + c;
            copy[static_cast<size_t>(row)] =
                static_cast<int>(m_size) + static_cast<int>(m_top_rows.size());
            m_top_rows.push_back(row);
        }
    for (const int p : m_halves[1]) {
        const SupernodalPanel& panel = m_panels[static_cast<size_t>(p)];
        for (int k = 0; k < panel.row_count; ++k) {
            int& row = m_rows[panel.rows_begin + static_cast<size_t>(k)];
            if (copy[static_cast<size_t>(row)] >= 0) row = copy[static_cast<size_t>(row)];
        }
    }
}

template <class Real>
size_t SupernodalCholesky<Real>::numbers(const std::vector<int>& panels) const {
    size_t sum = 0;
    for (const int p : panels) sum += m_panels[static_cast<size_t>(p)].numbers();
    return sum;
}

template <class Real>
double SupernodalCholesky<Real>::critical_share() const {
    const size_t first = numbers(m_halves[0]), second = numbers(m_halves[1]);
    const size_t inverse = m_top_rows.size() * m_top_rows.size();
    return (2.0 * double(std::max(first, second)) + 0.5 * double(inverse)) /
           double(std::max(2 * (first + second) + inverse, size_t(1)));
}

template <class Real>
void SupernodalCholesky<Real>::find_parts() {
    m_part_of.assign(static_cast<size_t>(m_size), static_cast<unsigned char>(Crew::top));
    for (size_t half = 0; half < 2; ++half)
        for (const int p : m_halves[half]) {
            const SupernodalPanel& panel = m_panels[static_cast<size_t>(p)];
            std::fill_n(m_part_of.begin() + panel.first, panel.width,
                        static_cast<unsigned char>(half));
        }
}

template <class Real>
void SupernodalCholesky<Real>::find_rows() {
    for (auto& rows : m_rows_of) rows.clear();
    for (size_t row = 0; row < m_part_of.size(); ++row) {
        auto& rows = m_rows_of[m_part_of[row]];
        const int at = static_cast<int>(row);
        if (rows.empty() || rows.back().end != at) rows.push_back({at, at});
        ++rows.back().end;
    }
}

template <class Real>
int SupernodalCholesky<Real>::threads() const {
    return m_values.size() < enough_numbers ? 1 : std::min(2, omp_get_max_threads());
}

template <class Real>
void SupernodalCholesky<Real>::take(size_t part, const Points& b, Real* work) const {
    for (const Rows& rows : m_rows_of[part])
        for (int row = rows.begin; row < rows.end; ++row)
            for (int k = 0; k < 3; ++k) work[4 * row + k] = static_cast<Real>(b(row, k));
}

template <class Real>
void SupernodalCholesky<Real>::give(size_t part, const Real* work, Points& x) const {
    for (const Rows& rows : m_rows_of[part])
        for (int row = rows.begin; row < rows.end; ++row)
            for (int k = 0; k < 3; ++k) x(row, k) = double(work[4 * row + k]);
}

template <class Real>
void SupernodalCholesky<Real>::eliminate_panels(const std::vector<int>& panels, Real* work) const {
    for (const int p : panels) {
        const SupernodalPanel& panel = m_panels[static_cast<size_t>(p)];
        OfWidth<Real>::eliminate[panel.width - 1](m_values.data() + panel.values_begin,
                                                  m_rows.data() + panel.rows_begin, panel.row_count,
                                                  work + 4 * panel.first, work);
    }
}

template <class Real>
void SupernodalCholesky<Real>::substitute_back_panels(const std::vector<int>& panels,
                                                      Real* work) const {
    for (auto p = panels.rbegin(); p != panels.rend(); ++p) {
        const SupernodalPanel& panel = m_panels[static_cast<size_t>(*p)];
        OfWidth<Real>::substitute_back[panel.width - 1](
            m_values.data() + panel.values_begin, m_rows.data() + panel.rows_begin, panel.row_count,
            work + 4 * panel.first, work);
    }
}

/// Solves with the top's panels for the unit vectors, three at a time.
template <class Real>
void SupernodalCholesky<Real>::invert_top() {
    const size_t count = m_top_rows.size();
    m_top_inverse.assign(strip * strips() * count, Real(0));
    std::vector<Real> work(4 * static_cast<size_t>(m_size), Real(0));
    const auto top_row = [&](size_t k) { return &work[4 * static_cast<size_t>(m_top_rows[k])]; };
    for (size_t first = 0; first < count; first += 3) {
        const size_t columns = std::min(count - first, size_t(3));
        for (size_t k = 0; k < count; ++k) std::fill_n(top_row(k), 4, Real(0));
        for (size_t c = 0; c < columns; ++c) top_row(first + c)[c] = Real(1);
        eliminate_panels(m_top, work.data());
        substitute_back_panels(m_top, work.data());
        for (size_t k = 0; k < count; ++k)
            for (size_t c = 0; c < columns; ++c)
                m_top_inverse[(k / strip * count + first + c) * strip + k % strip] = top_row(k)[c];
    }
}

/// Half of the rows of the top, for which each thread gathers what both halves have left there.
template <class Real>
void SupernodalCholesky<Real>::solve_top(size_t half, Real* work) const {
    const size_t count = m_top_rows.size();
    const Real* const copy = work + 4 * m_size;
    Real* const gathered = work + 4 * gathered_begin(half);
    for (size_t k = 0; k < count; ++k)
        store<Real>(gathered + 4 * k, load(work + 4 * m_top_rows[k]) + load(copy + 4 * k));
    const size_t middle = strips() / 2;
    for (size_t k = half == 0 ? 0 : middle; k < (half == 0 ? middle : strips()); ++k)
        multiply<Real, strip>(m_top_inverse.data() + k * count * strip, gathered, count,
                              work + 4 * (product_begin() + k * strip));
}

/// To where the half's panels look for the top.
template <class Real>
void SupernodalCholesky<Real>::take_top(size_t half, Real* work) const {
    const Real* const product = work + 4 * product_begin();
    for (size_t k = 0; k < m_top_rows.size(); ++k) {
        Real* const to = work + 4 * (half == 0 ? m_top_rows[k] : m_size + static_cast<int>(k));
        store<Real>(to, load(product + 4 * k));
    }
}

template <class Real>
void SupernodalCholesky<Real>::solve(const Crew& crew, Real* work) const {
    crew.for_halves([&](size_t half) {
        if (half == 1) std::fill_n(work + 4 * m_size, 4 * m_top_rows.size(), Real(0));
        eliminate_panels(m_halves[half], work);
    });
    Crew::wait();
    crew.for_halves([&](size_t half) { solve_top(half, work); });
    Crew::wait();
    crew.for_halves([&](size_t half) {
        take_top(half, work);
        substitute_back_panels(m_halves[half], work);
    });
}

template <class Real>
void SupernodalCholesky<Real>::solve(const Points& b, Points& x) const {
    static thread_local std::vector<Real> lanes;  // x, y, z, and 0 for ever
    if (lanes.size() < 4 * work_rows()) lanes.resize(4 * work_rows(), Real(0));
    x.resize(b.rows(), 3);
    Real* const work = lanes.data();
    const int together = threads();
#pragma omp parallel num_threads(together) if (together > 1)
    {
        const Crew crew;
        crew.for_parts([&](size_t part) { take(part, b, work); });
        solve(crew, work);
        crew.for_parts([&](size_t part) { give(part, work, x); });
    }
}

template class SupernodalCholesky<float>;
template class SupernodalCholesky<double>;

}  // namespace cloth
