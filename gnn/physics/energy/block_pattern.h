#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <mutex>
#include <optional>
#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// Where the 3 x 3 block of a pair of vertices lies in the values of the sparse Hessian: entry
/// (row, column) of the block is at begin + column * stride + row. begin < 0: one of the vertices
/// is pinned and the block is dropped.
struct BlockSlot {
    int begin;
    int stride;
};

/// Whether the Hessian is exact, or each element's part of it is made positive semi-definite.
enum class HessianKind { exact, projected };

/// Adds a block (N/m) to the values of a matrix of the pattern.
inline void add_block(double* values, BlockSlot slot, const Eigen::Matrix3d& block) {
    if (slot.begin < 0) return;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            values[slot.begin + column * slot.stride + row] += block(row, column);
}

/// Sparsity of a garment's Hessian (3|V| x 3|V|, both triangles): one 3 x 3 block per pair of
/// vertices that share a face or a hinge. Found once, so that each Hessian only refills values.
/// Rows and columns of pinned vertices hold their diagonal alone.
class BlockPattern {
 public:
    explicit BlockPattern(const Garment& garment);

    /// Gives `matrix` this pattern, unless it has it already, and sets all values to zero but the
    /// diagonal of pinned vertices, which becomes one.
    void reset(Eigen::SparseMatrix<double>& matrix) const;

    /// Slot of a vertex with itself.
    BlockSlot diagonal(Eigen::Index vertex) const {
        return m_diagonal[static_cast<size_t>(vertex)];
    }
    /// Slots of a face, row by row: (corner i, corner j) at 3 i + j.
    const std::array<BlockSlot, 9>& face(size_t f) const { return m_faces[f]; }
    /// Slots of a hinge, row by row: (corner i, corner j) at 4 i + j.
    const std::array<BlockSlot, 16>& hinge(size_t h) const { return m_hinges[h]; }

 private:
    bool matches(const Eigen::SparseMatrix<double>& matrix) const;
    BlockSlot find(int row, int column) const;

    const Garment* m_garment;
    Eigen::SparseMatrix<double> m_pattern;  ///< all ones
    std::vector<std::vector<int>> m_neighbours;
    std::vector<BlockSlot> m_diagonal;
    std::vector<std::array<BlockSlot, 9>> m_faces;
    std::vector<std::array<BlockSlot, 16>> m_hinges;
};

/// The pattern of a garment, found when it is first asked for: quasi-Newton iterations need none,
/// and it is a quarter of their memory. Several threads may ask.
class LazyBlockPattern {
 public:
    /// Keeps a reference to `garment`.
    explicit LazyBlockPattern(const Garment& garment) : m_garment(&garment) {}

    const BlockPattern& get() const {
        std::call_once(m_once, [this] { m_pattern.emplace(*m_garment); });
        return *m_pattern;
    }

 private:
    const Garment* m_garment;
    mutable std::once_flag m_once;
    mutable std::optional<BlockPattern> m_pattern;
};

}  // namespace cloth
