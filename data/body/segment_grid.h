#pragma once

#include <array>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// Answers whether segments hit a fixed triangle surface: faces sorted into a regular grid, cells
/// walked along the segment (Amanatides and Woo 1987). For loading time, not for every frame.
class SegmentGrid {
 public:
    /// @param cell  edge of a cell (m), about the size of the faces
    SegmentGrid(const Points& vertices, const Faces& faces, double cell);

    /// True if a face meets the segment between `from` and `to`.
    bool hits(const Vec3& from, const Vec3& to) const;

 private:
    using Cell = std::array<int, 3>;

    Cell cell_of(const Vec3& x) const;
    bool is_inside(const Cell& cell) const;
    size_t index_of(const Cell& cell) const;
    bool face_hits(int face, const Vec3& from, const Vec3& way) const;

    const Points& m_vertices;
    const Faces& m_faces;
    double m_cell;
    Vec3 m_low;
    Cell m_size;
    std::vector<std::vector<int>> m_cells;  ///< faces whose box touches the cell
};

}  // namespace cloth
