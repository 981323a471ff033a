#include "demos/hard_cases/odd_meshes.h"

#include <cmath>
#include <utility>
#include <vector>

namespace cloth {
namespace {

/// A surface under construction.
class Draft {
 public:
    int add(double x, double z) {
        m_points.emplace_back(x, 0.0, z);
        return static_cast<int>(m_points.size()) - 1;
    }
    int add(const Vec3& p) { return add(p.x(), p.z()); }

    /// Turned so that its normal is +y.
    void face(int a, int b, int c) {
        const Vec3 u = at(b) - at(a), v = at(c) - at(a);
        if (u.cross(v).y() < 0.0) std::swap(b, c);
        m_faces.emplace_back(a, b, c);
    }
    void quad(int a, int b, int c, int d) {
        face(a, b, c);
        face(a, c, d);
    }
    /// Three faces about a new vertex in the middle.
    void split_face(int a, int b, int c) {
        const int middle = add(Vec3((at(a) + at(b) + at(c)) / 3.0));
        face(a, b, middle);
        face(b, c, middle);
        face(c, a, middle);
    }

    TriMesh mesh() const {
        TriMesh mesh{Points(static_cast<Eigen::Index>(m_points.size()), 3),
                     Faces(static_cast<Eigen::Index>(m_faces.size()), 3)};
        for (size_t i = 0; i < m_points.size(); ++i)
            mesh.vertices.row(static_cast<Eigen::Index>(i)) = m_points[i];
        for (size_t i = 0; i < m_faces.size(); ++i)
            mesh.faces.row(static_cast<Eigen::Index>(i)) = m_faces[i];
        return mesh;
    }

 private:
    const Vec3& at(int i) const { return m_points[static_cast<size_t>(i)]; }

    std::vector<Vec3> m_points;
    std::vector<Eigen::RowVector3i> m_faces;
};

/// `sectors` points on a circle, every other circle turned by half a sector.
std::vector<int> add_circle(Draft& draft, double radius, int sectors, int ring) {
    std::vector<int> circle;
    for (int k = 0; k < sectors; ++k) {
        const double angle = 2.0 * M_PI * (k + 0.5 * (ring % 2)) / sectors;
        circle.push_back(draft.add(radius * std::cos(angle), radius * std::sin(angle)));
    }
    return circle;
}

/// Calls face(a, b, c) for the triangles between two neighbouring circles.
template <typename Face>
void join_circles(const std::vector<int>& inner, const std::vector<int>& outer, int ring,
                  const Face& face) {
    const size_t n = inner.size();
    for (size_t k = 0; k < n; ++k) {
        const size_t next = (k + 1) % n;
        if (ring % 2 == 1) {  // the outer circle is ahead by half a sector
            face(inner[k], outer[k], inner[next]);
            face(inner[next], outer[k], outer[next]);
        } else {
            face(inner[k], outer[k], outer[next]);
            face(inner[k], outer[next], inner[next]);
        }
    }
}

}  // namespace

TriMesh mixed_triangles() {
    constexpr int sectors = 24;
    constexpr double inner = 0.004, outer = 0.2;
    constexpr int rings = 18;
    Draft draft;
    std::vector<int> before = add_circle(draft, inner, sectors, 0);
    for (int ring = 1; ring <= rings; ++ring) {
        const double radius = inner * std::pow(outer / inner, static_cast<double>(ring) / rings);
        const std::vector<int> circle = add_circle(draft, radius, sectors, ring);
        join_circles(before, circle, ring, [&](int a, int b, int c) { draft.face(a, b, c); });
        before = circle;
    }
    return draft.mesh();
}

TriMesh needle_sheet() {
    constexpr double size = 0.6, gap = 9.6e-4;
    constexpr int rows = 11, pairs = 12;
    Draft draft;
    std::vector<std::vector<int>> columns;
    for (int pair = 0; pair < pairs; ++pair)
        for (const double side : {0.0, gap}) {
            const double x = size * pair / (pairs - 1) - 0.5 * size + side;
            std::vector<int> column;
            for (int row = 0; row <= rows; ++row)
                column.push_back(draft.add(x, size * row / rows - 0.5 * size));
            columns.push_back(column);
        }
    for (size_t c = 0; c + 1 < columns.size(); ++c)
        for (size_t r = 0; r < rows; ++r)
            draft.quad(columns[c][r], columns[c + 1][r], columns[c + 1][r + 1], columns[c][r + 1]);
    return draft.mesh();
}

TriMesh uneven_degrees() {
    constexpr int sectors = 10, rings = 6;
    constexpr double radius = 0.3;
    Draft draft;
    const auto split = [&](int a, int b, int c) { draft.split_face(a, b, c); };
    const int middle = draft.add(0.0, 0.0);
    std::vector<int> before = add_circle(draft, radius / rings, sectors, 1);
    for (size_t k = 0; k < sectors; ++k) split(middle, before[k], before[(k + 1) % sectors]);
    for (int ring = 2; ring <= rings; ++ring) {
        const std::vector<int> circle = add_circle(draft, radius * ring / rings, sectors, ring);
        join_circles(before, circle, ring, split);
        before = circle;
    }
    return draft.mesh();
}

}  // namespace cloth
