#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "data/core/types.h"

namespace cloth {

/// The point of a triangle that is closest to a query point.
struct TriangleHit {
    Vec3 barycentric;    ///< exactly zero for corners that do not span the closest feature
    double squared = 0;  ///< squared distance (m^2)
};

/// Closest point of the triangle abc to q. Ericson, Real-Time Collision Detection (2005), 5.1.5:
/// the Voronoi region that q lies in decides whether a corner, an edge or the inside is closest.
/// A triangle without area gives a point of one of its edges.
inline TriangleHit closest_on_triangle(const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, aq = q - a;
    const auto corner = [](const Vec3& weights, const Vec3& offset) {
        return TriangleHit{weights, offset.squaredNorm()};
    };
    const double d1 = ab.dot(aq), d2 = ac.dot(aq);
    if (d1 <= 0 && d2 <= 0) return corner({1, 0, 0}, aq);

    const Vec3 bq = q - b;
    const double d3 = ab.dot(bq), d4 = ac.dot(bq);
    if (d3 >= 0 && d4 <= d3) return corner({0, 1, 0}, bq);

    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const double t = d1 / (d1 - d3);
        return {{1 - t, t, 0}, (aq - t * ab).squaredNorm()};
    }

    const Vec3 cq = q - c;
    const double d5 = ab.dot(cq), d6 = ac.dot(cq);
    if (d6 >= 0 && d5 <= d6) return corner({0, 0, 1}, cq);

    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const double t = d2 / (d2 - d6);
        return {{1 - t, 0, t}, (aq - t * ac).squaredNorm()};
    }

    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return {{0, 1 - t, t}, (bq - t * (c - b)).squaredNorm()};
    }

    const double scale = 1.0 / (va + vb + vc);
    const double v = vb * scale, w = vc * scale;
    return {{1 - v - w, v, w}, (aq - v * ab - w * ac).squaredNorm()};
}

/// Where a line meets the plane of a triangle abc.
struct LineHit {
    double at = 0.0;  ///< from + at * way
    double u = 0.0,
           v = 0.0;  ///< a + u (b - a) + v (c - a): in the triangle if u, v, 1 - u - v >= 0

    bool is_inside(double slack = 0.0) const {
        return u >= -slack && v >= -slack && u + v <= 1.0 + slack;
    }
};

/// Where the line `from` + at * `way` meets the plane of the triangle abc; nothing if it is
/// parallel to it or the triangle has no area. Moeller and Trumbore 1997.
inline std::optional<LineHit> meet_line(const Vec3& from, const Vec3& way, const Vec3& a,
                                        const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    const Vec3 across = way.cross(ac);
    const double volume = ab.dot(across);
    if (volume == 0.0) return std::nullopt;
    const Vec3 offset = from - a;
    const Vec3 turned = offset.cross(ab);
    return LineHit{ac.dot(turned) / volume, offset.dot(across) / volume, way.dot(turned) / volume};
}

/// Angle (rad) between two vectors, 0 to pi.
inline double angle_between(const Vec3& u, const Vec3& v) {
    return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Area vector times two of the triangle abc, or nothing usable: false if the triangle's height is
/// below 1e-10 of its longest edge or a coordinate is not finite.
inline bool triangle_cross(const Vec3& a, const Vec3& b, const Vec3& c, Vec3& cross) {
    const Vec3 ab = b - a, ac = c - a;
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
    cross = ab.cross(ac);
    return cross.squaredNorm() > 1e-20 * longest * longest;
}

inline bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    Vec3 cross;
    return triangle_cross(a, b, c, cross);
}

/// Unit normal of the triangle abc (counter-clockwise seen from outside); false, and a zero normal,
/// if it has no area.
inline bool triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c, Vec3& normal) {
    if (!triangle_cross(a, b, c, normal)) {
        normal.setZero();
        return false;
    }
    normal.normalize();
    return true;
}

}  // namespace cloth
