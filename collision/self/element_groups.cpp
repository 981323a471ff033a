#include "collision/self/element_groups.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "collision/geometry/eight_lanes.h"
#include "collision/self/offset_regions.h"

namespace cloth {
namespace {

constexpr double rounding = 1e-6;  // of single precision, with room for what is done with it
constexpr float relative = 1e-5f;  // what single precision leaves of a product of few
constexpr float far_away = 1e15f;  // m, of lanes without an element: its square is finite

using Lanes = EightFloats;

Lanes magnitude(const Lanes& a) {
    return a < 0.0f ? -a : a;
}

/// No less than a vector's length, and no more by a twelfth: quicker than a root.
Lanes length_bound(const Lanes (&a)[3]) {
    const Lanes x = magnitude(a[0]), y = magnitude(a[1]), z = magnitude(a[2]);
    return 0.5858f * larger(larger(x, y), z) + 0.4143f * (x + y + z);
}

Lanes dot(const Lanes (&a)[3], const Lanes (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Where eight things are along each axis (m), and how they move.
struct Intervals {
    Lanes from[3], to[3], least[3], most[3];

    /// Those that come within `reach` of a box: a bit for each.
    template <typename Box>
    unsigned near(const Box& box, float reach) const {
        const Lanes zero = {};
        EightFlags found = {-1, -1, -1, -1, -1, -1, -1, -1};
        for (int k = 0; k < 3; ++k) {
            const Lanes down = smaller(least[k] - box.most_motion[k], zero);
            const Lanes up = larger(most[k] - box.least_motion[k], zero);
            found &= (from[k] + down <= Lanes{} + (box.high[k] + reach)) &
                     (to[k] + up >= Lanes{} + (box.low[k] - reach));
        }
        return bits(found);
    }
};

template <size_t lanes>
void put(const Vec3& v, size_t lane, float (&to)[3][lanes]) {
    for (int k = 0; k < 3; ++k) to[k][lane] = static_cast<float>(v[k]);
}

}  // namespace

ElementGroups::ElementGroups(const Garment& garment, Which which)
    : m_which(which), m_elements(garment), m_groups(garment.rest().vertices, garment.rest().faces) {
    make_groups();
    if (which == Which::near) return;
    m_beyond_face = OffsetRegions(garment).beyond_faces();
    m_rings.resize(m_groups.count());
}

void ElementGroups::make_groups() {
    const auto leave_empty = [](auto& element, auto& face, auto& place) {
        element.fill(-1);
        face.fill(-1);
        std::fill(std::begin(place[0]), std::end(place[0]), far_away);
    };
    const auto add_corners = [&] {
        Corners& corners = m_corners.emplace_back();
        leave_empty(corners.vertex, corners.face, corners.at);
    };
    const auto add_rods = [&] {
        Rods& rods = m_rods.emplace_back();
        leave_empty(rods.edge, rods.face, rods.middle);
    };
    for (size_t group = 0; group < m_groups.count(); ++group) {
        m_begin.push_back({m_corners.size(), m_rods.size()});
        Discs& discs = m_discs.emplace_back();
        std::fill(std::begin(discs.centre[0]), std::end(discs.centre[0]), far_away);
        discs.face = m_groups.faces(static_cast<int>(group));
        size_t edges = 0, vertices = 0;
        for (const int face : discs.face) {
            if (face < 0) break;
            for (const int vertex : m_elements.vertices_of(face)) {
                if (vertex < 0) break;
                const size_t lane = vertices++ % width;
                if (lane == 0) add_corners();
                m_corners.back().vertex[lane] = vertex;
                m_corners.back().face[lane] = face;
            }
            for (const int edge : m_elements.edges_of(face)) {
                if (edge < 0) break;
                const size_t lane = edges++ % width;
                if (lane == 0) add_rods();
                m_rods.back().edge[lane] = edge;
                m_rods.back().face[lane] = face;
            }
        }
    }
    m_begin.push_back({m_corners.size(), m_rods.size()});
    m_boxes.resize(m_groups.count());
}

void ElementGroups::find(const Points& x, const Points& motion, double reach, int threads) {
    m_groups.find(x, motion, reach, threads);
    m_found = m_groups.found();
    measure(x, motion, reach);
    for (size_t group = 0; group < m_groups.count(); ++group) update(x, motion, group);
    if (m_which == Which::near) return;
    m_places.resize(static_cast<size_t>(x.rows()));
    for (size_t i = 0; i < m_places.size(); ++i)
        for (Eigen::Index axis = 0; axis < 3; ++axis)
            m_places[i][static_cast<size_t>(axis)] =
                static_cast<float>(x(static_cast<Eigen::Index>(i), axis) - m_origin[axis]);
    for (size_t group = 0; group < m_rings.size(); ++group) update_rings(group);
}

void ElementGroups::find_changed(const Points& x, const Points& motion,
                                 const std::vector<char>& changed, double reach, int threads) {
    m_groups.find(x, motion, reach, threads);
    measure(x, motion, reach);
    m_changed.resize(m_groups.count());
    for (size_t group = 0; group < m_groups.count(); ++group) {
        m_changed[group] = has_any(changed, group) ? 1 : 0;
        if (m_changed[group]) update(x, motion, group);
    }
    m_found.clear();
    for (const auto& pair : m_groups.found())
        if (m_changed[static_cast<size_t>(pair[0])] || m_changed[static_cast<size_t>(pair[1])])
            m_found.push_back(pair);
}

void ElementGroups::measure(const Points& x, const Points& motion, double reach) {
    if (x.rows() == 0) return;
    m_origin = x.row(0);
    m_reach = static_cast<float>(reach);
    const double size = (x.rowwise() - x.row(0)).cwiseAbs().maxCoeff();
    m_rounding = static_cast<float>(rounding * size + 1e-12);
    m_box_reach =
        m_reach + 2.0f * (m_rounding + static_cast<float>(rounding * motion.cwiseAbs().maxCoeff()));
}

bool ElementGroups::has_any(const std::vector<char>& marked, size_t group) const {
    for (const int face : m_discs[group].face) {
        if (face < 0) break;
        for (int k = 0; k < 3; ++k)
            if (marked[static_cast<size_t>(m_elements.faces()(face, k))]) return true;
    }
    return false;
}

void ElementGroups::update(const Points& x, const Points& motion, size_t group) {
    update_faces(x, motion, group);
    for (size_t c = m_begin[group].corners; c < m_begin[group + 1].corners; ++c)
        update(x, motion, m_corners[c]);
    for (size_t r = m_begin[group].rods; r < m_begin[group + 1].rods; ++r)
        update(x, motion, m_rods[r]);
}

void ElementGroups::update(const Points& x, const Points& motion, Corners& corners) const {
    for (size_t lane = 0; lane < width && corners.vertex[lane] >= 0; ++lane) {
        const Vec3 at = x.row(corners.vertex[lane]), moved = motion.row(corners.vertex[lane]);
        put(at - m_origin, lane, corners.at);
        put(moved, lane, corners.motion);
    }
}

void ElementGroups::update_faces(const Points& x, const Points& motion, size_t group) {
    Discs& discs = m_discs[group];
    Eigen::AlignedBox3d places, moves;
    for (size_t lane = 0; lane < width && discs.face[lane] >= 0; ++lane) {
        const auto face = m_elements.faces().row(discs.face[lane]);
        const Vec3 a = x.row(face[0]), b = x.row(face[1]), c = x.row(face[2]);
        const Vec3 u = motion.row(face[0]), v = motion.row(face[1]), w = motion.row(face[2]);
        const Vec3 centre = (a + b + c) / 3.0, mean = (u + v + w) / 3.0;
        const auto farthest = [](const Vec3& from, const Vec3& p, const Vec3& q, const Vec3& r) {
            return std::sqrt(std::max(
                {(p - from).squaredNorm(), (q - from).squaredNorm(), (r - from).squaredNorm()}));
        };
        for (const Vec3& corner : {a, b, c}) places.extend(corner - m_origin);
        for (const Vec3& moved : {u, v, w}) moves.extend(moved);
        put(centre - m_origin, lane, discs.centre);
        put((b - a).cross(c - a).normalized(), lane, discs.normal);
        discs.radius[lane] = static_cast<float>((1.0 + rounding) * farthest(centre, a, b, c));
        put(mean, lane, discs.motion.mean);
        discs.motion.radius[lane] =
            static_cast<float>((1.0 + rounding) * farthest(mean, u, v, w) + rounding * mean.norm());
    }
    Box& box = m_boxes[group];
    for (int k = 0; k < 3; ++k) {
        box.low[k] = static_cast<float>(places.min()[k]);
        box.high[k] = static_cast<float>(places.max()[k]);
        box.least_motion[k] = static_cast<float>(moves.min()[k]);
        box.most_motion[k] = static_cast<float>(moves.max()[k]);
    }
}

void ElementGroups::update_rings(size_t group) {
    Rings& around = m_rings[group];
    const FaceGroups::Lanes& faces = m_discs[group].face;
    for (size_t lane = 0; lane < width && faces[lane] >= 0; ++lane)
        for (size_t k = 0; k < 3; ++k) {
            const int corner = m_elements.faces()(faces[lane], static_cast<Eigen::Index>(k));
            const int beyond = m_beyond_face[static_cast<size_t>(faces[lane])][k];
            const auto& a = m_places[static_cast<size_t>(corner)];
            const auto& b = m_places[static_cast<size_t>(beyond < 0 ? corner : beyond)];
            for (size_t axis = 0; axis < 3; ++axis) {
                around.corner[k][axis][lane] = a[axis];
                around.beyond[k][axis][lane] = b[axis];
            }
        }
}

void ElementGroups::update(const Points& x, const Points& motion, Rods& rods) const {
    for (size_t lane = 0; lane < width && rods.edge[lane] >= 0; ++lane) {
        const auto& [a, b] = m_elements.edges()[static_cast<size_t>(rods.edge[lane])];
        const Vec3 start = x.row(a), half = 0.5 * (x.row(b).transpose() - start);
        const Vec3 moved = motion.row(a), half_motion = 0.5 * (motion.row(b).transpose() - moved);
        put(start + half - m_origin, lane, rods.middle);
        put(half, lane, rods.half);
        rods.length[lane] = static_cast<float>((1.0 + rounding) * half.norm());
        const Vec3 mean = moved + half_motion;
        put(mean, lane, rods.motion.mean);
        rods.motion.radius[lane] =
            static_cast<float>((1.0 + rounding) * half_motion.norm() + rounding * mean.norm());
    }
}

unsigned ElementGroups::compare(const Corners& corners, const Box& box) const {
    Intervals intervals;
    for (int k = 0; k < 3; ++k) {
        intervals.from[k] = intervals.to[k] = load_eight(corners.at[k]);
        intervals.least[k] = intervals.most[k] = load_eight(corners.motion[k]);
    }
    return intervals.near(box, m_box_reach);
}

unsigned ElementGroups::compare(const Rods& rods, const Box& box) const {
    Intervals intervals;
    const Lanes spread = load_eight(rods.motion.radius);
    for (int k = 0; k < 3; ++k) {
        const Lanes middle = load_eight(rods.middle[k]), mean = load_eight(rods.motion.mean[k]);
        const Lanes half = magnitude(load_eight(rods.half[k]));
        intervals.from[k] = middle - half;
        intervals.to[k] = middle + half;
        intervals.least[k] = mean - spread;
        intervals.most[k] = mean + spread;
    }
    return intervals.near(box, m_box_reach);
}

ElementGroups::Near ElementGroups::near_edges(size_t group, size_t other) const {
    Near near = {};
    const size_t begin = m_begin[group].rods, end = m_begin[group + 1].rods;
    for (size_t r = begin; r < end; ++r) near[r - begin] = compare(m_rods[r], m_boxes[other]);
    return near;
}

/// From outside the face, above its plane by less than it is beside the face, nothing faces it.
unsigned ElementGroups::compare(const Corners& corners, size_t lane, const Discs& discs) const {
    Lanes to[3], normal[3], drift[3];
    for (int k = 0; k < 3; ++k) {
        to[k] = corners.at[k][lane] - load_eight(discs.centre[k]);
        normal[k] = load_eight(discs.normal[k]);
        drift[k] = corners.motion[k][lane] - load_eight(discs.motion.mean[k]);
    }
    const Lanes approach = length_bound(drift) + load_eight(discs.motion.radius);
    const Lanes far = (1.0f + 1e-6f) * (m_reach + approach), radius = load_eight(discs.radius);
    const Lanes squared = dot(to, to), limit = radius + far + m_rounding;
    EightFlags found = squared <= limit * limit;
    if (m_which == Which::facing) {
        const Lanes height = dot(to, normal);
        const Lanes beside = (1.0f + relative) * (radius + magnitude(height)) + m_rounding;
        found &= squared - height * height <= beside * beside;
    }
    return bits(found);
}

/// Faces of a group whose point closest to the vertex is on their border, where a face beyond is
/// nearer for certain: OffsetRegions in lanes.
unsigned ElementGroups::nearer_beyond(const Corners& corners, size_t lane, size_t group) const {
    const Rings& around = m_rings[group];
    const Discs& discs = m_discs[group];
    Lanes to[3][3], along[3][3], up[3][3], normal[3];  // from each corner
    for (size_t k = 0; k < 3; ++k) {
        normal[k] = load_eight(discs.normal[k]);
        for (size_t axis = 0; axis < 3; ++axis) {
            const Lanes corner = load_eight(around.corner[k][axis]);
            to[k][axis] = corners.at[axis][lane] - corner;
            along[k][axis] = load_eight(around.corner[(k + 1) % 3][axis]) - corner;
            up[k][axis] = load_eight(around.beyond[k][axis]) - corner;
        }
    }
    // Each vector is off by twice the rounding of its ends, and products by their own.
    const auto room = [&](const Lanes& a, const Lanes& b) {
        return 2.0f * m_rounding * (a + b) + relative * a * b;
    };
    const Lanes edge = 2.0f * load_eight(discs.radius), distance = length_bound(to[0]) + edge;
    const Lanes little = 2.0f * room(distance, edge);
    Lanes where[3];  // along each edge
    for (size_t k = 0; k < 3; ++k) where[k] = dot(to[k], along[k]);
    EightFlags found = {};
    for (size_t k = 0; k < 3; ++k) {
        const size_t before = (k + 2) % 3;
        const Lanes height = length_bound(up[k]), length = dot(along[k], along[k]);
        const Lanes rise = dot(up[k], to[k]), share = dot(up[k], along[k]);
        const Lanes out[3] = {along[k][1] * normal[2] - along[k][2] * normal[1],
                              along[k][2] * normal[0] - along[k][0] * normal[2],
                              along[k][0] * normal[1] - along[k][1] * normal[0]};
        const EightFlags beside =
            (where[k] > little) & (length - where[k] > little) & (dot(to[k], out) > little);
        const Lanes sum = 2.0f * edge *
                          (height * room(distance, edge) + distance * room(height, edge) +
                           edge * room(distance, height));
        found |= beside & (length * rise - share * where[k] > sum);
        const EightFlags at_corner =
            (where[k] < -little) & (where[before] - dot(along[before], along[before]) > little);
        Lanes other[3];  // beyond the edge that ends here
        for (size_t axis = 0; axis < 3; ++axis)
            other[axis] = up[before][axis] - along[before][axis];
        found |= at_corner & ((rise > 2.0f * room(height, distance)) |
                              (dot(other, to[k]) > 2.0f * room(length_bound(other), distance)));
    }
    return bits(found);
}

/// Near: what the edges extend along the line between their middles is less than these are apart.
/// Edges face each other where their lines are nearest between the ends of both.
unsigned ElementGroups::compare(const Rods& a, size_t lane, const Rods& b) const {
    Lanes to[3], first[3], second[3], drift[3];
    for (int k = 0; k < 3; ++k) {
        to[k] = load_eight(b.middle[k]) - a.middle[k][lane];
        first[k] = Lanes{} + a.half[k][lane];
        second[k] = load_eight(b.half[k]);
        drift[k] = load_eight(b.motion.mean[k]) - a.motion.mean[k][lane];
    }
    const Lanes approach =
        length_bound(drift) + (load_eight(b.motion.radius) + a.motion.radius[lane]);
    const Lanes far = (1.0f + 1e-6f) * (m_reach + approach);
    const Lanes squared = dot(to, to), ut = dot(first, to), vt = dot(second, to);
    if (m_which == Which::near) {
        const Lanes limit = far + m_rounding;
        const Lanes gap = (1.0f - relative) * squared - (magnitude(ut) + magnitude(vt));
        return bits((gap <= 0.0f) | (gap * gap <= squared * limit * limit));
    }
    const Lanes u = Lanes{} + a.length[lane], v = load_eight(b.length), uv = dot(first, second);
    const Lanes limit = u + v + far + m_rounding;
    const unsigned close = bits(squared <= limit * limit);
    if (close == 0) return 0;
    const Lanes room = relative * limit + m_rounding;  // of `to`
    const Lanes scale = (1.0f + relative) * u * u * v * v - uv * uv;
    return close & bits((magnitude(ut * v * v - uv * vt) <= scale + u * v * v * room) &
                        (magnitude(uv * ut - u * u * vt) <= scale + u * u * v * room));
}

}  // namespace cloth
