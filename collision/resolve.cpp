#include "collision/resolve.h"

#include <algorithm>

namespace cloth {

int project_out(const SurfaceContacts& contacts, double distance, Points& x) {
    int moved = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (!contacts.has(i)) continue;
        const auto normal = contacts.normal1.row(i);
        const double height = normal.dot(x.row(i) - contacts.point1.row(i));
        if (!(height < distance)) continue;
        x.row(i) += (distance - height) * normal;
        ++moved;
    }
    return moved;
}

/// Unit direction in which the signed distance grows: away from the closest point outside, towards
/// it inside, the face's normal on the surface itself.
static Vec3 outward(const SurfaceContacts& contacts, Eigen::Index i, const Points& x) {
    const Vec3 away = x.row(i) - contacts.point1.row(i);
    const double length = away.norm();
    if (length < 1e-9) return contacts.normal1.row(i);
    return away * ((contacts.distance[i] < 0.0 ? -1.0 : 1.0) / length);
}

static int push_to_distance(const SurfaceContacts& contacts, double distance, Points& x) {
    // A vertex that rounding leaves below the distance is not worth another iteration.
    const double threshold = distance - 1e-9;
    int moved = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (!contacts.has(i) || !(contacts.distance[i] < threshold)) continue;
        const Vec3 direction = outward(contacts, i, x);
        x.row(i) = contacts.point1.row(i) + distance * direction.transpose();
        ++moved;
    }
    return moved;
}

static double max_depth(const VectorX& distance) {
    return distance.size() > 0 ? std::max(0.0, -distance.minCoeff()) : 0.0;
}

ResolveReport resolve_penetration(Proximity& proximity, const Boundary& boundary, double distance,
                                  Points& x, int max_iterations) {
    SurfaceContacts contacts;
    return resolve_penetration(proximity, boundary, distance, x, contacts, max_iterations);
}

ResolveReport resolve_penetration(Proximity& proximity, const Boundary& boundary, double distance,
                                  Points& x, SurfaceContacts& contacts, int max_iterations) {
    ResolveReport report;
    if (boundary.obstacles.empty()) return report;
    for (;; ++report.iterations) {
        proximity.query(x, boundary, contacts, StepEnd::end);
        report.max_depth_after = max_depth(contacts.distance);
        if (report.iterations == 0) report.max_depth_before = report.max_depth_after;
        if (report.iterations == max_iterations) break;
        const int moved = push_to_distance(contacts, distance, x);
        report.moved += moved;
        if (moved == 0) break;
    }
    return report;
}

}  // namespace cloth
