#include "collision/self/self_tangles.h"

#include <algorithm>
#include <cmath>

#include "collision/geometry/gather_in_order.h"

namespace cloth {

constexpr double in_plane = 1e-9;  // of an edge's length: flat cloth lies in the planes of its
                                   // own faces up to rounding

/// The edge must part the plane's sides, and pass the three edges of the face on the same side:
/// signs of volumes (Segura and Feito 2001, "Algorithms to test ray-triangle intersection").
bool edge_crosses_face(const Vec3& p0, const Vec3& p1, const Vec3& a, const Vec3& b, const Vec3& c,
                       Vec3& point) {
    const Vec3 normal = (b - a).cross(c - a);
    const double h0 = normal.dot(p0 - a), h1 = normal.dot(p1 - a);
    const Vec3 along = p1 - p0;
    const double least = in_plane * std::sqrt(normal.squaredNorm() * along.squaredNorm());
    if (!((h0 > least && h1 < -least) || (h0 < -least && h1 > least))) return false;
    const double u = along.dot((a - p0).cross(b - p0));
    const double v = along.dot((b - p0).cross(c - p0));
    const double w = along.dot((c - p0).cross(a - p0));
    if (!((u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0))) return false;
    point = p0 + h0 / (h0 - h1) * along;
    return true;
}

SelfTangles::SelfTangles(const Garment& garment)
    : m_elements(garment),
      m_faces(garment.rest().vertices, garment.rest().faces),
      m_still(Points::Zero(garment.vertex_count(), 3)) {
}

void SelfTangles::add(int edge, int face, const Points& x, std::vector<Tangle>& out) const {
    if (edge < 0) return;
    const auto& [p, q] = m_elements.edges()[static_cast<size_t>(edge)];
    const auto corners = m_elements.faces().row(face);
    for (int k = 0; k < 3; ++k)
        if (corners[k] == p || corners[k] == q) return;
    Tangle tangle{edge, face, Vec3::Zero()};
    if (edge_crosses_face(x.row(p), x.row(q), x.row(corners[0]), x.row(corners[1]),
                          x.row(corners[2]), tangle.point))
        out.push_back(tangle);
}

bool SelfTangles::is_at(const Tangle& tangle, const std::vector<char>& marked) const {
    if (marked.empty()) return false;
    const auto is = [&](int i) { return marked[static_cast<size_t>(i)] != 0; };
    const auto& [p, q] = m_elements.edges()[static_cast<size_t>(tangle.edge)];
    const auto at = m_elements.faces().row(tangle.face);
    return is(p) || is(q) || is(at[0]) || is(at[1]) || is(at[2]);
}

const std::vector<Tangle>& SelfTangles::find(const Points& x, int threads,
                                             const std::vector<char>& overlapped) {
    m_found.clear();
    if (!x.allFinite()) return m_found;
    m_faces.find(x, m_still, 0.0, threads);
    const auto& faces = m_faces.found();
    const auto find = [&](int k, std::vector<Tangle>& out) {
        const auto& [f, g] = faces[static_cast<size_t>(k)];
        for (const int edge : m_elements.edges_of(f)) add(edge, g, x, out);
        for (const int edge : m_elements.edges_of(g)) add(edge, f, x, out);
    };
    gather_each_in_order(static_cast<int>(faces.size()), threads, m_parts, m_found, find);
    if (!overlapped.empty())
        m_found.erase(
            std::remove_if(m_found.begin(), m_found.end(),
                           [&](const Tangle& tangle) { return is_at(tangle, overlapped); }),
            m_found.end());
    return m_found;
}

}  // namespace cloth
