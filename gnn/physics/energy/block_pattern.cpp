#include "gnn/physics/energy/block_pattern.h"

#include <algorithm>

namespace cloth {

namespace {

using Neighbours = std::vector<std::vector<int>>;

template <typename Corners>
void connect(const Corners& corners, int count, const std::vector<char>& pinned,
             Neighbours& neighbours) {
    for (int i = 0; i < count; ++i)
        for (int j = 0; j < count; ++j) {
            const size_t a = static_cast<size_t>(corners[i]);
            if (!pinned[a] && !pinned[static_cast<size_t>(corners[j])])
                neighbours[a].push_back(corners[j]);
        }
}

/// Sorted neighbours of every vertex, itself included; pinned vertices have only themselves.
Neighbours find_neighbours(const Garment& garment) {
    Neighbours neighbours(static_cast<size_t>(garment.vertex_count()));
    for (size_t v = 0; v < neighbours.size(); ++v) neighbours[v].push_back(static_cast<int>(v));
    for (Eigen::Index f = 0; f < garment.face_count(); ++f)
        connect(garment.rest().faces.row(f), 3, garment.is_pinned(), neighbours);
    for (const Hinge& hinge : garment.hinges()) connect(hinge, 4, garment.is_pinned(), neighbours);
    for (std::vector<int>& list : neighbours) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return neighbours;
}

Eigen::SparseMatrix<double> matrix_of_ones(const Neighbours& neighbours) {
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(neighbours.size());
    Eigen::SparseMatrix<double> matrix(size, size);
    Eigen::VectorXi counts(size);
    for (Eigen::Index column = 0; column < size; ++column)
        counts[column] = 3 * static_cast<int>(neighbours[static_cast<size_t>(column / 3)].size());
    matrix.reserve(counts);
    for (Eigen::Index column = 0; column < size; ++column)
        for (int neighbour : neighbours[static_cast<size_t>(column / 3)])
            for (int axis = 0; axis < 3; ++axis) matrix.insert(3 * neighbour + axis, column) = 1.0;
    matrix.makeCompressed();
    return matrix;
}

}  // namespace

BlockPattern::BlockPattern(const Garment& garment)
    : m_garment(&garment), m_neighbours(find_neighbours(garment)) {
    m_pattern = matrix_of_ones(m_neighbours);
    for (Eigen::Index v = 0; v < garment.vertex_count(); ++v)
        m_diagonal.push_back(find(static_cast<int>(v), static_cast<int>(v)));
    m_faces.resize(static_cast<size_t>(garment.face_count()));
    for (size_t f = 0; f < m_faces.size(); ++f) {
        const auto face = garment.rest().faces.row(static_cast<Eigen::Index>(f));
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                m_faces[f][static_cast<size_t>(3 * i + j)] = find(face[i], face[j]);
    }
    m_hinges.resize(garment.hinges().size());
    for (size_t h = 0; h < m_hinges.size(); ++h)
        for (size_t i = 0; i < 4; ++i)
            for (size_t j = 0; j < 4; ++j)
                m_hinges[h][4 * i + j] = find(garment.hinges()[h][i], garment.hinges()[h][j]);
    m_neighbours = {};
}

BlockSlot BlockPattern::find(int row, int column) const {
    const std::vector<char>& pinned = m_garment->is_pinned();
    if (pinned[static_cast<size_t>(row)] || pinned[static_cast<size_t>(column)]) return {-1, 0};
    const std::vector<int>& list = m_neighbours[static_cast<size_t>(column)];
    const auto place = std::lower_bound(list.begin(), list.end(), row) - list.begin();
    return {m_pattern.outerIndexPtr()[3 * column] + 3 * static_cast<int>(place),
            3 * static_cast<int>(list.size())};
}

bool BlockPattern::matches(const Eigen::SparseMatrix<double>& matrix) const {
    if (!matrix.isCompressed() || matrix.rows() != m_pattern.rows() ||
        matrix.cols() != m_pattern.cols() || matrix.nonZeros() != m_pattern.nonZeros())
        return false;
    const int *outer = m_pattern.outerIndexPtr(), *inner = m_pattern.innerIndexPtr();
    return std::equal(outer, outer + m_pattern.cols() + 1, matrix.outerIndexPtr()) &&
           std::equal(inner, inner + m_pattern.nonZeros(), matrix.innerIndexPtr());
}

void BlockPattern::reset(Eigen::SparseMatrix<double>& matrix) const {
    if (!matches(matrix)) matrix = m_pattern;
    std::fill(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros(), 0.0);
    for (int pin : m_garment->pins())
        for (int axis = 0; axis < 3; ++axis)
            matrix.valuePtr()[matrix.outerIndexPtr()[3 * pin + axis] + axis] = 1.0;
}

}  // namespace cloth
