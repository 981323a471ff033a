#include "collision/proximity/mesh_surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "data/core/mesh.h"
#include "data/core/triangle.h"

namespace cloth {

/// Marks the ends of edges that have one face only.
static std::vector<char> on_open_edge(Eigen::Index vertex_count, const Faces& faces) {
    std::vector<std::array<int, 2>> edges;
    edges.reserve(static_cast<size_t>(faces.size()));
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int k = 0; k < 3; ++k) {
            const int a = faces(f, k), b = faces(f, (k + 1) % 3);
            edges.push_back({std::min(a, b), std::max(a, b)});
        }
    std::sort(edges.begin(), edges.end());
    std::vector<char> open(static_cast<size_t>(vertex_count), 0);
    for (size_t i = 0; i < edges.size();) {
        size_t end = i + 1;
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        if (end == i + 1) open[size_t(edges[i][0])] = open[size_t(edges[i][1])] = 1;
        i = end;
    }
    return open;
}

static std::vector<int> weld_open_edges(const Points& vertices, const Faces& faces) {
    const std::vector<char> open = on_open_edge(vertices.rows(), faces);
    std::vector<int> weld(open.size());
    std::iota(weld.begin(), weld.end(), 0);
    std::map<std::array<double, 3>, int> first_at;
    for (size_t i = 0; i < open.size(); ++i) {
        const Vec3 x = vertices.row(static_cast<Eigen::Index>(i));
        if (!open[i] || !x.allFinite()) continue;
        weld[i] = first_at.emplace(std::array<double, 3>{x[0], x[1], x[2]}, weld[i]).first->second;
    }
    return weld;
}

VertexFaces::VertexFaces(const Points& vertices, const Faces& faces)
    : m_weld(weld_open_edges(vertices, faces)), m_first(m_weld.size() + 1, 0) {
    for (Eigen::Index i = 0; i < faces.size(); ++i) ++m_first[size_t(welded(faces.data()[i])) + 1];
    std::partial_sum(m_first.begin(), m_first.end(), m_first.begin());
    m_faces.resize(static_cast<size_t>(faces.size()));
    std::vector<int> next(m_first.begin(), m_first.end() - 1);
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int k = 0; k < 3; ++k)
            m_faces[size_t(next[size_t(welded(faces(f, k)))]++)] = static_cast<int>(f);
}

MeshSurface::MeshSurface(std::shared_ptr<const Faces> faces, const Points& vertices, double radius,
                         const std::vector<std::uint8_t>* limbs)
    : m_faces(std::move(faces)),
      m_tree(vertices, *m_faces, radius, limbs),
      m_vertex_faces(std::make_shared<const VertexFaces>(vertices, *m_faces)) {
}

SurfaceHit MeshSurface::closest(const Vec3& q, double radius, int hint,
                                ClosestFaceTree::Stack& stack, LimbSet ignored) const {
    return with_sign(m_tree.closest(q, radius, hint, stack, ignored), q, ignored);
}

void MeshSurface::closest(const ClosestFaceTree::Query* queries, int count,
                          ClosestFaceTree::Stack& stack, SurfaceHit* hits) const {
    FaceHit found[ClosestFaceTree::packet];
    m_tree.closest(queries, count, stack, found);
    for (int k = 0; k < count; ++k) hits[k] = with_sign(found[k], queries[k].x, queries[k].ignored);
}

SurfaceHit MeshSurface::with_sign(const FaceHit& hit, const Vec3& q, LimbSet ignored) const {
    if (hit.face < 0) return {};
    Vec3 point = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
        point += hit.barycentric[k] * m_tree.vertices().row((*m_faces)(hit.face, k)).transpose();
    const bool inside_face = (hit.barycentric.array() != 0.0).all();
    return inside_face ? on_face(hit, q - point) : on_edge_or_vertex(hit, q - point, ignored);
}

Vec3 MeshSurface::normal(int face) const {
    const Points& x = m_tree.vertices();
    Vec3 normal = Vec3::Zero();
    triangle_normal(x.row((*m_faces)(face, 0)), x.row((*m_faces)(face, 1)),
                    x.row((*m_faces)(face, 2)), normal);
    return normal;
}

std::optional<Cover> MeshSurface::cover(const Vec3& point, int face, double length,
                                        ClosestFaceTree::Stack& stack, LimbSet ignored) const {
    constexpr double start = 1e-5;  // m: off the face itself
    const Vec3 up = normal(face);
    if (up.isZero(0.0)) return std::nullopt;
    const auto hit = m_tree.first_hit(point + start * up, up, length, stack, ignored);
    if (!hit || !(hit->distance > 0.0) || !(normal(hit->face).dot(up) > 0.0)) return std::nullopt;
    return Cover{hit->distance, hit->face};
}

static double signed_root(double squared, bool negative) {
    return negative ? -std::sqrt(squared) : std::sqrt(squared);
}

SurfaceHit MeshSurface::on_face(const FaceHit& hit, const Vec3& away) const {
    const Points& x = m_tree.vertices();
    const Vec3 a = x.row((*m_faces)(hit.face, 0));
    const Vec3 b = x.row((*m_faces)(hit.face, 1));
    const Vec3 c = x.row((*m_faces)(hit.face, 2));
    const bool inside = (b - a).cross(c - a).dot(away) < 0.0;
    return {hit.face, hit.barycentric, signed_root(hit.squared, inside), m_tree.limb(hit.face)};
}

/// Angle (rad) of the corner `pivot` between the corners before and after it.
static double corner_angle(const std::array<Vec3, 3>& corners, int pivot) {
    const Vec3 u = corners[size_t((pivot + 1) % 3)] - corners[size_t(pivot)];
    const Vec3 v = corners[size_t((pivot + 2) % 3)] - corners[size_t(pivot)];
    return angle_between(u, v);
}

int MeshSurface::corner_at(int face, int vertex) const {
    for (int k = 0; k < 3; ++k) {
        const int corner = (*m_faces)(face, k);
        if (corner == vertex) return k;
        if (m_vertex_faces->welded(corner) == m_vertex_faces->welded(vertex) &&
            m_tree.vertices().row(corner) == m_tree.vertices().row(vertex))
            return k;
    }
    return -1;
}

SurfaceHit MeshSurface::on_edge_or_vertex(const FaceHit& hit, const Vec3& away,
                                          LimbSet ignored) const {
    int ends[2] = {-1, -1};  // the feature's vertices; the second is -1 at a vertex
    double weights[2] = {0.0, 0.0};
    for (int k = 0, end = 0; k < 3; ++k)
        if (hit.barycentric[k] != 0.0) {
            ends[end] = (*m_faces)(hit.face, k);
            weights[end++] = hit.barycentric[k];
        }

    int front = -1, back = -1;  // the faces most squarely before and behind the point
    double front_height = 0.0, back_height = 0.0, weighted = 0.0;
    bool at_border = false;  // of a limb that is passed over
    LimbSet limbs = 0;
    for (const int* face = m_vertex_faces->begin(ends[0]); face != m_vertex_faces->end(ends[0]);
         ++face) {
        const int pivot = corner_at(*face, ends[0]);
        if (pivot < 0 || (ends[1] >= 0 && corner_at(*face, ends[1]) < 0)) continue;
        limbs |= m_tree.limb(*face);
        std::array<Vec3, 3> corners;
        for (int k = 0; k < 3; ++k)
            corners[size_t(k)] = m_tree.vertices().row((*m_faces)(*face, k));
        Vec3 normal;
        if (!triangle_normal(corners[0], corners[1], corners[2], normal)) continue;
        const double height = normal.dot(away);
        weighted += height * (ends[1] < 0 ? corner_angle(corners, pivot) : 1.0);
        if ((m_tree.limb(*face) & ignored) != 0) {
            at_border = true;
            continue;
        }
        if (front < 0 || height > front_height) front = *face, front_height = height;
        if (back < 0 || height < back_height) back = *face, back_height = height;
    }

    const bool inside = weighted < 0.0;
    SurfaceHit result;
    result.limbs = limbs;
    if (at_border && inside) return result;  // none: in the limb that is passed over
    result.face = inside ? back : front;
    result.distance = signed_root(hit.squared, inside);
    for (const int end : {0, 1})
        if (ends[end] >= 0) result.barycentric[corner_at(result.face, ends[end])] = weights[end];
    return result;
}

}  // namespace cloth
