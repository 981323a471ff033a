#define EIGEN_DONT_PARALLELIZE  // one thread per subtree instead

#include "gnn/physics/solver/block_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "gnn/physics/solver/elimination_tree.h"

namespace cloth {

namespace {

using Matrix = Eigen::MatrixXd;
using MatrixMap = Eigen::Map<Matrix>;

/// Explicit zeros that a front may hold for being wider, as a share of its panel.
constexpr double max_padding = 0.3;
/// Panels below this many blocks are merged regardless of their zeros.
constexpr int small_panel = 24;
/// Subtrees of fewer multiplications are not worth a task of their own.
constexpr double task_work = 1e6;
/// Matrices of fewer multiplications are not worth waking threads.
constexpr double parallel_work = 1e8;

Graph block_graph(const Eigen::SparseMatrix<double>& matrix) {
    Graph graph(static_cast<size_t>(matrix.cols() / 3));
    for (size_t node = 0; node < graph.size(); ++node) {
        const int column = 3 * static_cast<int>(node);
        for (int k = matrix.outerIndexPtr()[column]; k < matrix.outerIndexPtr()[column + 1];
             k += 3) {
            const int other = matrix.innerIndexPtr()[k] / 3;
            if (other != static_cast<int>(node)) graph[node].push_back(other);
        }
    }
    return graph;
}

/// Multiplications to eliminate `width` of `height` unknowns.
double elimination_work(double width, double height) {
    const double below = height - width;
    return width * (width * width / 6.0 + 0.5 * width * below + 0.5 * below * below);
}

}  // namespace

bool BlockCholesky::is_analysed_for(const Eigen::SparseMatrix<double>& matrix) const {
    return static_cast<size_t>(matrix.cols()) == 3 * m_position.size() &&
           static_cast<size_t>(matrix.nonZeros()) == m_source_nonzeros;
}

void BlockCholesky::analyse(const Eigen::SparseMatrix<double>& matrix) {
    const Graph graph = block_graph(matrix);
    m_position = elimination_order(graph);
    m_source_nonzeros = static_cast<size_t>(matrix.nonZeros());
    build_fronts(factor_structure(graph, m_position));
    link_fronts();
    place_entries(matrix);
}

/// Joins a column to the front before it when it is that front's parent and the zeros this adds are
/// few.
void BlockCholesky::build_fronts(const std::vector<std::vector<int>>& structure) {
    m_fronts.clear();
    size_t stored = 0;
    for (size_t column = 0; column < structure.size(); ++column) {
        const size_t own = 1 + structure[column].size();
        if (column > 0 && !structure[column - 1].empty() &&
            structure[column - 1].front() == static_cast<int>(column)) {
            Front& front = m_fronts.back();
            const size_t width = static_cast<size_t>(front.width) + 1;
            const size_t dense = width * (width + 1) / 2 + width * (own - 1);
            const double padding = static_cast<double>(dense - stored - own);
            if (dense <= small_panel || padding <= max_padding * static_cast<double>(dense)) {
                front.width += 1;
                front.rows = structure[column];
                stored += own;
                continue;
            }
        }
        stored = own;
        m_fronts.push_back({static_cast<int>(column), 1, -1, structure[column], {}, {}, 0, 0.0});
    }
}

void BlockCholesky::link_fronts() {
    std::vector<int> front_of(m_position.size());
    for (size_t f = 0; f < m_fronts.size(); ++f)
        for (int c = 0; c < m_fronts[f].width; ++c)
            front_of[static_cast<size_t>(m_fronts[f].first + c)] = static_cast<int>(f);
    m_roots.clear();
    size_t values = 0;
    for (size_t f = 0; f < m_fronts.size(); ++f) {
        Front& front = m_fronts[f];
        front.values_begin = values;
        values += static_cast<size_t>(front.height()) * static_cast<size_t>(3 * front.width);
        front.subtree_work += elimination_work(3.0 * front.width, front.height());
        if (front.rows.empty()) {
            m_roots.push_back(static_cast<int>(f));
            continue;
        }
        front.parent = front_of[static_cast<size_t>(front.rows.front())];
        Front& parent = m_fronts[static_cast<size_t>(front.parent)];
        parent.children.push_back(static_cast<int>(f));
        parent.subtree_work += front.subtree_work;
        for (int row : front.rows) {
            const auto below = std::lower_bound(parent.rows.begin(), parent.rows.end(), row);
            const int place = row < parent.first + parent.width
                                  ? row - parent.first
                                  : parent.width + static_cast<int>(below - parent.rows.begin());
            front.in_parent.push_back(place);
        }
    }
    m_values.resize(values);
    m_updates.assign(m_fronts.size(), {});
}

void BlockCholesky::place_entries(const Eigen::SparseMatrix<double>& matrix) {
    std::vector<int> node_at(m_position.size());
    for (size_t node = 0; node < m_position.size(); ++node)
        node_at[static_cast<size_t>(m_position[node])] = static_cast<int>(node);
    m_entries.assign(m_fronts.size(), {});
    const int* outer = matrix.outerIndexPtr();
    for (size_t f = 0; f < m_fronts.size(); ++f) {
        const Front& front = m_fronts[f];
        for (int c = 0; c < front.width; ++c) {
            const int column = 3 * node_at[static_cast<size_t>(front.first + c)];
            const int stride = outer[column + 1] - outer[column];
            for (int k = outer[column]; k < outer[column + 1]; k += 3) {
                const int row = m_position[static_cast<size_t>(matrix.innerIndexPtr()[k] / 3)];
                if (row < front.first + c) continue;
                const auto below = std::lower_bound(front.rows.begin(), front.rows.end(), row);
                const int place = row < front.first + front.width
                                      ? row - front.first
                                      : front.width + static_cast<int>(below - front.rows.begin());
                m_entries[f].push_back({k, stride, place, c});
            }
        }
    }
}

bool BlockCholesky::factorise(const Eigen::SparseMatrix<double>& matrix, double shift) {
    bool positive = true;
    double work = 0.0;
    for (int root : m_roots) work += m_fronts[static_cast<size_t>(root)].subtree_work;
#pragma omp parallel if (work > parallel_work)
#pragma omp single
    for (int root : m_roots)
        positive = factorise_subtree(root, matrix.valuePtr(), shift) && positive;
    return positive;
}

bool BlockCholesky::factorise_subtree(int index, const double* source, double shift) {
    const std::vector<int>& children = m_fronts[static_cast<size_t>(index)].children;
    std::vector<char> positive(children.size(), 1);
    for (size_t c = 0; c < children.size(); ++c) {
        const bool large = m_fronts[static_cast<size_t>(children[c])].subtree_work > task_work;
#pragma omp task default(shared) firstprivate(c) if (large)
        positive[c] = factorise_subtree(children[c], source, shift);
    }
#pragma omp taskwait
    if (std::find(positive.begin(), positive.end(), 0) != positive.end()) return false;
    return factorise_front(index, source, shift);
}

bool BlockCholesky::factorise_front(int index, const double* source, double shift) {
    const Front& front = m_fronts[static_cast<size_t>(index)];
    const int width = 3 * front.width, height = front.height(), below = height - width;
    MatrixMap panel(m_values.data() + front.values_begin, height, width);
    panel.setZero();
    std::vector<double>& storage = m_updates[static_cast<size_t>(index)];
    storage.assign(static_cast<size_t>(below) * static_cast<size_t>(below), 0.0);
    MatrixMap update(storage.data(), below, below);

    for (const Entry& entry : m_entries[static_cast<size_t>(index)])
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r)
                panel(3 * entry.row + r, 3 * entry.column + c) =
                    source[entry.source + c * entry.stride + r];
    panel.topRows(width).diagonal().array() += shift;
    for (int child : front.children) take_update(child, panel, update);

    auto top = panel.topRows(width);
    Eigen::LLT<Eigen::Ref<Matrix>> cholesky(top);
    if (cholesky.info() != Eigen::Success) return false;
    if (below == 0) return true;
    auto bottom = panel.bottomRows(below);
    top.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(bottom);
    update.selfadjointView<Eigen::Lower>().rankUpdate(bottom, -1.0);
    return true;
}

/// Adds the update of a child (lower triangle) to its parent's panel and update, and frees it.
void BlockCholesky::take_update(int child, MatrixMap& panel, MatrixMap& update) {
    const std::vector<int>& places = m_fronts[static_cast<size_t>(child)].in_parent;
    const int count = static_cast<int>(places.size()), width = static_cast<int>(panel.cols());
    std::vector<double>& storage = m_updates[static_cast<size_t>(child)];
    const MatrixMap from(storage.data(), 3 * count, 3 * count);
    for (int column = 0; column < count; ++column)
        for (int c = 0; c < 3; ++c) {
            const int target = 3 * places[static_cast<size_t>(column)] + c;
            const int skipped = target < width ? 0 : width;  // rows above the update matrix
            double* to = target < width ? &panel(0, target) : &update(0, target - width);
            const double* own = &from(0, 3 * column + c);
            for (int row = column; row < count; ++row) {
                const int place = 3 * places[static_cast<size_t>(row)] - skipped;
                for (int r = 0; r < 3; ++r) to[place + r] += own[3 * row + r];
            }
        }
    storage = {};
}

void BlockCholesky::solve(VectorX& b) const {
    VectorX y(b.size());
    for (size_t node = 0; node < m_position.size(); ++node)
        y.segment<3>(3 * m_position[node]) = b.segment<3>(3 * static_cast<Eigen::Index>(node));
    for (const Front& front : m_fronts) eliminate(front, y);
    for (auto front = m_fronts.rbegin(); front != m_fronts.rend(); ++front) substitute(*front, y);
    for (size_t node = 0; node < m_position.size(); ++node)
        b.segment<3>(3 * static_cast<Eigen::Index>(node)) = y.segment<3>(3 * m_position[node]);
}

void BlockCholesky::eliminate(const Front& front, VectorX& y) const {
    const int width = 3 * front.width, below = front.height() - width;
    const Eigen::Map<const Matrix> panel(m_values.data() + front.values_begin, width + below,
                                         width);
    auto own = y.segment(3 * front.first, width);
    panel.topRows(width).triangularView<Eigen::Lower>().solveInPlace(own);
    const VectorX change = panel.bottomRows(below) * own;
    for (size_t r = 0; r < front.rows.size(); ++r)
        y.segment<3>(3 * front.rows[r]) -= change.segment<3>(3 * static_cast<Eigen::Index>(r));
}

void BlockCholesky::substitute(const Front& front, VectorX& y) const {
    const int width = 3 * front.width, below = front.height() - width;
    const Eigen::Map<const Matrix> panel(m_values.data() + front.values_begin, width + below,
                                         width);
    auto own = y.segment(3 * front.first, width);
    VectorX known(below);
    for (size_t r = 0; r < front.rows.size(); ++r)
        known.segment<3>(3 * static_cast<Eigen::Index>(r)) = y.segment<3>(3 * front.rows[r]);
    own -= panel.bottomRows(below).transpose() * known;
    panel.topRows(width).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
}

}  // namespace cloth
