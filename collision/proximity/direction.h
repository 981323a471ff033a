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

}  // namespace cloth
