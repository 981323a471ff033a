#include "collision/self/tangle_measure.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace cloth {
namespace {

constexpr double radius = 1e-2;  // m: r

}  // namespace

TangleMeasure::TangleMeasure(const Garment& garment)
    : m_tangles(garment),
      m_regions(garment),
      m_faces(garment.rest().faces),
      m_edges(garment.edges()),
      m_edge_faces(m_edges.size(), {-1, -1}),
      m_face_edges(static_cast<size_t>(garment.face_count())),
      m_face_areas(garment.face_areas()),
      m_cut(m_edges.size(), -1) {
    std::map<std::array<int, 2>, int> index;
    for (size_t e = 0; e < m_edges.size(); ++e)
        index[{std::min(m_edges[e][0], m_edges[e][1]), std::max(m_edges[e][0], m_edges[e][1])}] =
            static_cast<int>(e);
    for (int f = 0; f < m_faces.rows(); ++f)
        for (int k = 0; k < 3; ++k) {
            const int v = m_faces(f, k), w = m_faces(f, (k + 1) % 3);
            const int edge = index.at({std::min(v, w), std::max(v, w)});
            m_face_edges[static_cast<size_t>(f)][static_cast<size_t>(k)] = edge;
            std::array<int, 2>& faces = m_edge_faces[static_cast<size_t>(edge)];
            (faces[0] < 0 ? faces[0] : faces[1]) = f;
        }
}

double TangleMeasure::find(const Points& x, int threads, const std::vector<char>* known,
                           const std::vector<char>& overlapped) {
    m_length = m_area = 0.0;
    m_segments.clear();
    m_tangles.find(x, threads, overlapped);
    m_regions.find(tangles(), known);
    if (tangles().empty()) return 0.0;
    m_along.clear();
    for (const Tangle& tangle : tangles()) {
        const auto& [p, q] = m_edges[static_cast<size_t>(tangle.edge)];
        const Vec3 from = x.row(p), edge = x.row(q).transpose() - from;
        m_along.push_back(edge.dot(tangle.point - from) / edge.squaredNorm());
    }
    find_segments();
    measure_length(x);
    measure_area();
    return m_length + m_area / radius;
}

int TangleMeasure::common_vertex(int f, int g) const {
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
            if (m_faces(f, k) == m_faces(g, l)) return m_faces(f, k);
    return -1;
}

/// Two faces meet in a line with two ends. What rounding leaves of fewer or more has none.
void TangleMeasure::find_segments() {
    m_on_faces.clear();
    for (size_t k = 0; k < tangles().size(); ++k)
        for (const int f : m_edge_faces[static_cast<size_t>(tangles()[k].edge)]) {
            const int g = tangles()[k].face;
            if (f >= 0)
                m_on_faces.push_back({{std::min(f, g), std::max(f, g)}, static_cast<int>(k)});
        }
    std::sort(m_on_faces.begin(), m_on_faces.end(), [](const OnFace& a, const OnFace& b) {
        return a.faces != b.faces ? a.faces < b.faces : a.tangle < b.tangle;
    });
    for (size_t k = 0, end = 0; k < m_on_faces.size(); k = end) {
        while (end < m_on_faces.size() && m_on_faces[end].faces == m_on_faces[k].faces) ++end;
        const int vertex = common_vertex(m_on_faces[k].faces[0], m_on_faces[k].faces[1]);
        if (end - k == 2 && vertex < 0)
            m_segments.push_back({m_on_faces[k].tangle, m_on_faces[k + 1].tangle, -1});
        else if (end - k == 1 && vertex >= 0)
            m_segments.push_back({m_on_faces[k].tangle, -1, vertex});
    }
}

void TangleMeasure::measure_length(const Points& x) {
    for (const Segment& segment : m_segments) {
        const Vec3& from = tangles()[static_cast<size_t>(segment.tangle)].point;
        const Vec3 to = segment.other >= 0 ? tangles()[static_cast<size_t>(segment.other)].point
                                           : Vec3(x.row(segment.vertex));
        m_length += (to - from).norm();
    }
}

/// Of an edge with one end on the wrong side. @param sign  of its change with `along`
double TangleMeasure::wrong_share(int edge, double& sign) const {
    const double along = m_along[static_cast<size_t>(m_cut[static_cast<size_t>(edge)])];
    const bool first = m_regions.is_wrong(m_edges[static_cast<size_t>(edge)][0]);
    sign = first ? 1.0 : -1.0;
    return first ? along : 1.0 - along;
}

void TangleMeasure::measure_area() {
    m_slide.assign(tangles().size(), 0.0);
    std::fill(m_cut.begin(), m_cut.end(), -1);
    for (size_t k = 0; k < tangles().size(); ++k) {
        const int edge = tangles()[k].edge;
        int& cut = m_cut[static_cast<size_t>(edge)];
        if (!m_regions.is_parted(edge)) continue;
        // An edge that passes through several faces: all of it beyond the first is wrong.
        const bool first = m_regions.is_wrong(m_edges[static_cast<size_t>(edge)][0]);
        if (cut < 0 || (m_along[k] > m_along[static_cast<size_t>(cut)]) == first)
            cut = static_cast<int>(k);
    }
    for (int f = 0; f < m_faces.rows(); ++f) {
        int wrong = 0;
        for (int k = 0; k < 3; ++k) wrong += m_regions.is_wrong(m_faces(f, k));
        if (wrong == 0) continue;
        const double area = m_face_areas[f];
        if (wrong == 3) {
            m_area += area;
            continue;
        }
        // A corner is cut off by a line from one of its edges to the other.
        double corner = 1.0, share[2] = {0.0, 0.0}, sign[2] = {0.0, 0.0};
        int cut[2] = {0, 0}, found = 0;
        for (const int edge : m_face_edges[static_cast<size_t>(f)]) {
            if (!m_regions.is_parted(edge)) continue;
            cut[found] = m_cut[static_cast<size_t>(edge)];
            share[found] = wrong_share(edge, sign[found]);
            if (wrong == 2) share[found] = 1.0 - share[found];
            corner *= share[found++];
        }
        m_area += area * (wrong == 1 ? corner : 1.0 - corner);
        for (int k = 0; k < 2; ++k)
            m_slide[static_cast<size_t>(cut[k])] += area * sign[k] * share[1 - k];
    }
}

/// The point p = a + s (b - a) where an edge passes through a face of normal n (not unit) moves, to
/// first order, by
///
///     dp = (1 - s) da + s db + (b - a) ds,
///     ds = n ((1 - s) da + s db - sum of barycentric coordinates dc) / (n (a - b)).
///
/// @param pull   change of P with p. @param slide  with s (m)
void TangleMeasure::add_point(const Tangle& tangle, const Vec3& pull, double slide, const Points& x,
                              double steepest, Points& gradient) const {
    const auto& [p, q] = m_edges[static_cast<size_t>(tangle.edge)];
    const auto corner = m_faces.row(tangle.face);
    const Vec3 a = x.row(p), edge = x.row(q).transpose() - a;
    const Vec3 c0 = x.row(corner[0]), c1 = x.row(corner[1]), c2 = x.row(corner[2]);
    const Vec3 normal = (c1 - c0).cross(c2 - c0);
    const double twice_area = normal.norm(), length = edge.norm();
    if (!(twice_area > 0.0 && length > 0.0)) return;
    const double s = edge.dot(tangle.point - a) / (length * length);
    const double along_normal = normal.dot(edge) / (twice_area * length);
    const double steepness = std::copysign(
        std::min(1.0 / std::max(std::abs(along_normal), 1e-300), steepest), along_normal);
    const Vec3 lift = -(pull.dot(edge) + slide) * steepness / (twice_area * length) * normal;
    const double u = normal.dot((c2 - c1).cross(tangle.point - c1)) / (twice_area * twice_area);
    const double v = normal.dot((c0 - c2).cross(tangle.point - c2)) / (twice_area * twice_area);
    gradient.row(p) += (1.0 - s) * (pull + lift).transpose();
    gradient.row(q) += s * (pull + lift).transpose();
    gradient.row(corner[0]) -= u * lift.transpose();
    gradient.row(corner[1]) -= v * lift.transpose();
    gradient.row(corner[2]) -= (1.0 - u - v) * lift.transpose();
}

void TangleMeasure::gradient(const Points& x, Points& gradient, double steepest) {
    gradient.setZero(x.rows(), 3);
    m_pull.assign(tangles().size(), Vec3::Zero());
    for (const Segment& segment : m_segments) {
        const size_t tangle = static_cast<size_t>(segment.tangle);
        const Vec3 from = tangles()[tangle].point;
        const Vec3 to = segment.other >= 0 ? tangles()[static_cast<size_t>(segment.other)].point
                                           : Vec3(x.row(segment.vertex));
        const double length = (to - from).norm();
        if (!(length > 0.0)) continue;
        const Vec3 direction = (to - from) / length;
        m_pull[tangle] -= direction;
        if (segment.other >= 0)
            m_pull[static_cast<size_t>(segment.other)] += direction;
        else
            gradient.row(segment.vertex) += direction.transpose();
    }
    for (size_t k = 0; k < tangles().size(); ++k)
        add_point(tangles()[k], m_pull[k], m_slide[k] / radius, x, steepest, gradient);
}

}  // namespace cloth
