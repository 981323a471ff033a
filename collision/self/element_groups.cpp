#include "collision/self/element_groups.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "collision/geometry/eight_lanes.h"

namespace cloth {
namespace {

constexpr double rounding = 1e-6;  // of single precision, with room for what is done with it
constexpr float relative = 1e-5f;  // what single precision leaves of a product of few
constexpr float far_away = 1e15f;  // m, of lanes without an element: its square is finite

using Lanes = EightFloats;

Lanes root(const Lanes& squared) {
    Eigen::Array<float, 8, 1, Eigen::DontAlign> array;
    std::memcpy(array.data(), &squared, sizeof(squared));
    array = array.sqrt();
    return load_eight(array.data());
}

Lanes magnitude(const Lanes& a) {
    return a < 0.0f ? -a : a;
}

Lanes dot(const Lanes (&a)[3], const Lanes (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <size_t lanes>
void put(const Vec3& v, size_t lane, float (&to)[3][lanes]) {
    for (int k = 0; k < 3; ++k) to[k][lane] = static_cast<float>(v[k]);
}

}  // namespace

ElementGroups::ElementGroups(const Garment& garment)
    : m_elements(garment), m_groups(garment.rest().vertices, garment.rest().faces) {
    make_groups();
}

void ElementGroups::make_groups() {
    const auto no_rods = [] {
        Rods rods = {};
        rods.edge.fill(-1);
        rods.face.fill(-1);
        std::fill(std::begin(rods.middle[0]), std::end(rods.middle[0]), far_away);
        return rods;
    };
    for (size_t group = 0; group < m_groups.count(); ++group) {
        m_begin.push_back({m_corners.size(), m_rods.size()});
        Discs& discs = m_discs.emplace_back();
        std::fill(std::begin(discs.centre[0]), std::end(discs.centre[0]), far_away);
        discs.face = m_groups.faces(static_cast<int>(group));
        size_t edges = 0;
        for (const int face : discs.face) {
            if (face < 0) break;
            for (const int vertex : m_elements.vertices_of(face)) {
                if (vertex < 0) break;
                m_corners.push_back({{}, {}, vertex, face});
            }
            for (const int edge : m_elements.edges_of(face)) {
                if (edge < 0) break;
                const size_t lane = edges++ % width;
                if (lane == 0) m_rods.push_back(no_rods());
                m_rods.back().edge[lane] = edge;
                m_rods.back().face[lane] = face;
            }
        }
    }
    m_begin.push_back({m_corners.size(), m_rods.size()});
}

void ElementGroups::find(const Points& x, const Points& motion, double reach, int threads) {
    m_reach = static_cast<float>(reach);
    m_groups.find(x, motion, reach, threads);
    update(x, motion);
}

void ElementGroups::update(const Points& x, const Points& motion) {
    if (x.rows() == 0) return;
    const Vec3 origin = x.row(0);
    const double size = (x.rowwise() - x.row(0)).cwiseAbs().maxCoeff();
    m_rounding = static_cast<float>(rounding * size + 1e-12);
    for (Corner& corner : m_corners)
        for (int k = 0; k < 3; ++k) {
            corner.at[k] = static_cast<float>(x(corner.vertex, k) - origin[k]);
            corner.motion[k] = static_cast<float>(motion(corner.vertex, k));
        }
    for (Discs& discs : m_discs) update(x, motion, origin, discs);
    for (Rods& rods : m_rods) update(x, motion, origin, rods);
}

void ElementGroups::update(const Points& x, const Points& motion, const Vec3& origin,
                           Discs& discs) const {
    for (size_t lane = 0; lane < width && discs.face[lane] >= 0; ++lane) {
        const auto corner = m_elements.faces().row(discs.face[lane]);
        const Vec3 a = x.row(corner[0]), b = x.row(corner[1]), c = x.row(corner[2]);
        const Vec3 u = motion.row(corner[0]), v = motion.row(corner[1]), w = motion.row(corner[2]);
        const Vec3 centre = (a + b + c) / 3.0, mean = (u + v + w) / 3.0;
        const auto farthest = [](const Vec3& from, const Vec3& p, const Vec3& q, const Vec3& r) {
            return std::sqrt(std::max(
                {(p - from).squaredNorm(), (q - from).squaredNorm(), (r - from).squaredNorm()}));
        };
        put(centre - origin, lane, discs.centre);
        put((b - a).cross(c - a).normalized(), lane, discs.normal);
        discs.radius[lane] = static_cast<float>((1.0 + rounding) * farthest(centre, a, b, c));
        put(mean, lane, discs.motion.mean);
        discs.motion.radius[lane] =
            static_cast<float>((1.0 + rounding) * farthest(mean, u, v, w) + rounding * mean.norm());
    }
}

void ElementGroups::update(const Points& x, const Points& motion, const Vec3& origin,
                           Rods& rods) const {
    for (size_t lane = 0; lane < width && rods.edge[lane] >= 0; ++lane) {
        const auto& [a, b] = m_elements.edges()[static_cast<size_t>(rods.edge[lane])];
        const Vec3 start = x.row(a), half = 0.5 * (x.row(b).transpose() - start);
        const Vec3 moved = motion.row(a), half_motion = 0.5 * (motion.row(b).transpose() - moved);
        put(start + half - origin, lane, rods.middle);
        put(half, lane, rods.half);
        rods.length[lane] = static_cast<float>((1.0 + rounding) * half.norm());
        const Vec3 mean = moved + half_motion;
        put(mean, lane, rods.motion.mean);
        rods.motion.radius[lane] =
            static_cast<float>((1.0 + rounding) * half_motion.norm() + rounding * mean.norm());
    }
}

/// From outside the face, above its plane by less than it is beside the face, nothing faces it.
unsigned ElementGroups::compare(const Corner& corner, const Discs& discs, Which which) const {
    Lanes to[3], normal[3], drift[3];
    for (int k = 0; k < 3; ++k) {
        to[k] = corner.at[k] - load_eight(discs.centre[k]);
        normal[k] = load_eight(discs.normal[k]);
        drift[k] = corner.motion[k] - load_eight(discs.motion.mean[k]);
    }
    const Lanes approach = root(dot(drift, drift)) + load_eight(discs.motion.radius);
    const Lanes far = (1.0f + 1e-6f) * (m_reach + approach), radius = load_eight(discs.radius);
    const Lanes squared = dot(to, to), limit = radius + far + m_rounding;
    EightFlags found = squared <= limit * limit;
    if (which == Which::facing) {
        const Lanes height = dot(to, normal);
        const Lanes beside = (1.0f + relative) * (radius + magnitude(height)) + m_rounding;
        found &= squared - height * height <= beside * beside;
    }
    return bits(found);
}

/// Near: what the edges extend along the line between their middles is less than these are apart.
/// Edges face each other where their lines are nearest between the ends of both.
unsigned ElementGroups::compare(const Rods& a, int lane, const Rods& b, Which which) const {
    Lanes to[3], first[3], second[3], drift[3];
    for (int k = 0; k < 3; ++k) {
        to[k] = load_eight(b.middle[k]) - a.middle[k][lane];
        first[k] = Lanes{} + a.half[k][lane];
        second[k] = load_eight(b.half[k]);
        drift[k] = load_eight(b.motion.mean[k]) - a.motion.mean[k][lane];
    }
    const Lanes approach =
        root(dot(drift, drift)) + (load_eight(b.motion.radius) + a.motion.radius[lane]);
    const Lanes far = (1.0f + 1e-6f) * (m_reach + approach);
    const Lanes squared = dot(to, to), ut = dot(first, to), vt = dot(second, to);
    if (which == Which::near) {
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
