#include "collision/self/self_elements.h"

#include <algorithm>
#include <map>

#include "collision/geometry/segment.h"
#include "data/core/triangle.h"

namespace cloth {
namespace {

ClosestPoints closest_on_edges(const std::array<Vec3, 4>& x) {
    const SegmentHit hit = closest_on_segments(x[0], x[1], x[2], x[3]);
    ClosestPoints points;
    points.weight = {1.0 - hit.s, hit.s, hit.t - 1.0, -hit.t};
    points.offset = (x[0] - x[2]) + hit.s * (x[1] - x[0]) - hit.t * (x[3] - x[2]);
    points.squared = hit.squared;
    points.facing = hit.s > 0.0 && hit.s < 1.0 && hit.t > 0.0 && hit.t < 1.0;
    return points;
}

ClosestPoints closest_on_face(const std::array<Vec3, 4>& x) {
    const TriangleHit hit = closest_on_triangle(x[0], x[1], x[2], x[3]);
    const Vec3 ab = x[2] - x[1], ac = x[3] - x[1];
    ClosestPoints points;
    points.weight = {1.0, -hit.barycentric[0], -hit.barycentric[1], -hit.barycentric[2]};
    points.offset = (x[0] - x[1]) - hit.barycentric[1] * ab - hit.barycentric[2] * ac;
    points.squared = hit.squared;
    const Vec3 normal = ab.cross(ac);
    const double height = normal.dot(points.offset);
    points.facing = height * height > 0.5 * normal.squaredNorm() * points.squared;
    return points;
}

void own(std::array<int, 3>& list, int element) {
    *std::find(list.begin(), list.end(), -1) = element;
}

}  // namespace

ClosestPoints closest_points(bool edges, const std::array<Vec3, 4>& corners) {
    return edges ? closest_on_edges(corners) : closest_on_face(corners);
}

SelfElements::SelfElements(const Garment& garment)
    : m_faces(garment.rest().faces),
      m_edges(garment.edges()),
      m_own_vertices(static_cast<size_t>(garment.face_count()), {-1, -1, -1}),
      m_own_edges(m_own_vertices) {
    std::map<std::array<int, 2>, int> index;
    for (size_t e = 0; e < m_edges.size(); ++e)
        index[{std::min(m_edges[e][0], m_edges[e][1]), std::max(m_edges[e][0], m_edges[e][1])}] =
            static_cast<int>(e);
    std::vector<char> vertex_taken(static_cast<size_t>(garment.vertex_count()), 0);
    std::vector<char> edge_taken(m_edges.size(), 0);
    for (Eigen::Index f = 0; f < m_faces.rows(); ++f)
        for (int k = 0; k < 3; ++k) {
            const int v = m_faces(f, k), w = m_faces(f, (k + 1) % 3);
            const int edge = index.at({std::min(v, w), std::max(v, w)});
            if (!vertex_taken[static_cast<size_t>(v)]++)
                own(m_own_vertices[static_cast<size_t>(f)], v);
            if (!edge_taken[static_cast<size_t>(edge)]++)
                own(m_own_edges[static_cast<size_t>(f)], edge);
        }
}

}  // namespace cloth
