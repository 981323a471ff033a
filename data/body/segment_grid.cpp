#include "data/body/segment_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "data/core/triangle.h"

namespace cloth {

SegmentGrid::SegmentGrid(const Points& vertices, const Faces& faces, double cell)
    : m_vertices(vertices), m_faces(faces), m_cell(cell) {
    // Rounding must not lose a face between two cells to a segment on their border.
    const Vec3 slack = Vec3::Constant(1e-6 * cell);
    m_low = vertices.colwise().minCoeff().transpose() - 2.0 * slack;
    m_size = cell_of(vertices.colwise().maxCoeff().transpose() + 2.0 * slack);
    for (int& count : m_size) ++count;
    m_cells.resize(static_cast<size_t>(m_size[0]) * static_cast<size_t>(m_size[1]) *
                   static_cast<size_t>(m_size[2]));
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f) {
        const Vec3 a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1));
        const Vec3 c = vertices.row(faces(f, 2));
        const Cell low = cell_of(a.cwiseMin(b).cwiseMin(c) - slack);
        const Cell high = cell_of(a.cwiseMax(b).cwiseMax(c) + slack);
        for (int x = low[0]; x <= high[0]; ++x)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int z = low[2]; z <= high[2]; ++z) m_cells[index_of({x, y, z})].push_back(f);
    }
}

SegmentGrid::Cell SegmentGrid::cell_of(const Vec3& x) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
        cell[axis] = static_cast<int>(std::floor((x[axis] - m_low[axis]) / m_cell));
    return cell;
}

bool SegmentGrid::is_inside(const Cell& cell) const {
    for (int axis = 0; axis < 3; ++axis)
        if (cell[axis] < 0 || cell[axis] >= m_size[axis]) return false;
    return true;
}

size_t SegmentGrid::index_of(const Cell& cell) const {
    return (static_cast<size_t>(cell[0]) * static_cast<size_t>(m_size[1]) +
            static_cast<size_t>(cell[1])) *
               static_cast<size_t>(m_size[2]) +
           static_cast<size_t>(cell[2]);
}

bool SegmentGrid::hits(const Vec3& from, const Vec3& to) const {
    const Vec3 way = to - from;
    Cell cell = cell_of(from);
    const Cell last = cell_of(to);
    Vec3 next, step;  // parameter along the segment: of the next cell border, between borders
    Cell direction;
    for (int axis = 0; axis < 3; ++axis) {
        direction[axis] = way[axis] > 0.0 ? 1 : -1;
        const int border = cell[axis] + (way[axis] > 0.0 ? 1 : 0);
        const bool still = way[axis] == 0.0;
        step[axis] = still ? std::numeric_limits<double>::infinity() : m_cell / std::abs(way[axis]);
        next[axis] = still ? std::numeric_limits<double>::infinity()
                           : (m_low[axis] + border * m_cell - from[axis]) / way[axis];
    }
    const int cell_count =
        std::abs(last[0] - cell[0]) + std::abs(last[1] - cell[1]) + std::abs(last[2] - cell[2]) + 1;
    for (int visited = 0; visited < cell_count; ++visited) {
        if (is_inside(cell))
            for (int face : m_cells[index_of(cell)])
                if (face_hits(face, from, way)) return true;
        int axis = 0;
        next.minCoeff(&axis);
        cell[axis] += direction[axis];
        next[axis] += step[axis];
    }
    return false;
}

bool SegmentGrid::face_hits(int face, const Vec3& from, const Vec3& way) const {
    constexpr double slack = 1e-9;  // no gap between neighbours for a segment along their edge
    const auto hit = meet_line(from, way, m_vertices.row(m_faces(face, 0)),
                               m_vertices.row(m_faces(face, 1)), m_vertices.row(m_faces(face, 2)));
    return hit && hit->is_inside(slack) && hit->at >= 0.0 && hit->at <= 1.0;
}

}  // namespace cloth
