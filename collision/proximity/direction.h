#pragma once

#include "collision/proximity/proximity.h"

namespace cloth {

/// Unit direction in which the signed distance of point i of `x` (at t + dt) grows: away from its
/// closest point outside, towards it inside, the face's normal on the surface itself.
inline Vec3 outward(const SurfaceContacts& contacts, Eigen::Index i, const Points& x) {
    const Vec3 away = x.row(i) - contacts.point1.row(i);
    const double length = away.norm();
    if (length < 1e-9) return contacts.normal1.row(i);
    return away * ((contacts.distance[i] < 0.0 ? -1.0 : 1.0) / length);
}

/// Unit direction at t in which the signed distance of point i of `x` grows: away from its closest
/// point outside, towards it inside, the face's normal on the surface itself. On smooth parts of a
/// surface that is the normal; at its edges and corners it is not.
inline Vec3 direction_at_start(const SurfaceContacts& contacts, Eigen::Index i, const Points& x) {
    const Vec3 away = x.row(i) - contacts.point0.row(i);
    const double length = away.norm();
    if (length < 1e-6) return contacts.normal0.row(i);
    return away * ((contacts.distance[i] < 0.0 ? -1.0 : 1.0) / length);
}

/// `v` turned by the shortest rotation from one unit vector to another.
inline Vec3 turned(const Vec3& v, const Vec3& from, const Vec3& to) {
    const Vec3 axis = from.cross(to);
    const double cosine = from.dot(to);
    if (cosine < -0.999) return to;  // the rotation is not defined; no surface turns so far
    const Vec3 across = axis.cross(v);
    return v + across + axis.cross(across) / (1.0 + cosine);
}

/// direction_at_start() carried to t + dt: turned as the face turns.
inline Vec3 carried_direction(const SurfaceContacts& contacts, Eigen::Index i, const Points& x) {
    return turned(direction_at_start(contacts, i, x), contacts.normal0.row(i),
                  contacts.normal1.row(i));
}

/// Whether a surface turns from one unit normal to another by more than they are rounded.
inline bool turns(const Vec3& from, const Vec3& to) {
    constexpr double rounding = 1e-9;  // rad
    return (to - from).squaredNorm() > rounding * rounding;
}

/// How far (m) the surface takes point i of `x` (at t) along until t + dt if it sticks there: as
/// far as its closest point moves, and around that as the face turns. The motion of the closest
/// point alone falls short on a surface that turns, as the point stands above it.
inline Vec3 carried_motion(const SurfaceContacts& contacts, Eigen::Index i, const Points& x) {
    const Vec3 move = contacts.point1.row(i) - contacts.point0.row(i);
    const Vec3 from = contacts.normal0.row(i), to = contacts.normal1.row(i);
    if (!turns(from, to) || from.dot(to) < -0.999) return move;  // see turned()
    const Vec3 offset = x.row(i) - contacts.point0.row(i);
    return move + (turned(offset, from, to) - offset);
}

}  // namespace cloth
