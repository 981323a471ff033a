#include "collision/response/resolve.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "collision/proximity/direction.h"

namespace cloth {

int project_out(const SurfaceContacts& contacts, double distance, Points& x, double kept) {
    int moved = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (!contacts.has(i)) continue;
        const auto normal = contacts.normal1.row(i);
        const double height = normal.dot(x.row(i) - contacts.point1.row(i));
        const double least =
            kept > 0.0 ? std::clamp(contacts.distance[i], distance - kept, distance) : distance;
        if (!(height < least)) continue;
        x.row(i) += (least - height) * normal;
        ++moved;
    }
    return moved;
}

/// Keeps the rows whose distance is below `distance`; what rounding leaves below does not count.
static void keep_too_close(const SurfaceContacts& contacts, double distance,
                           std::vector<int>& rows) {
    const auto is_fine = [&](int i) { return !(contacts.distance[i] < distance - 1e-9); };
    rows.erase(std::remove_if(rows.begin(), rows.end(), is_fine), rows.end());
}

static void push_to_distance(const SurfaceContacts& contacts, double distance,
                             const std::vector<int>& rows, Points& x) {
    for (const int i : rows) {
        const Vec3 direction = outward(contacts, i, x);
        x.row(i) = contacts.point1.row(i) + distance * direction.transpose();
    }
}

static double max_depth(const VectorX& distance) {
    return distance.size() > 0 ? std::max(0.0, -distance.minCoeff()) : 0.0;
}

int push_out_rows(Proximity& proximity, const Boundary& boundary, double distance,
                  int max_iterations, std::vector<int>& rows, Points& x, SurfaceContacts& contacts,
                  int* moved, const QueryLimits& limits) {
    int iterations = 0;
    keep_too_close(contacts, distance, rows);
    if (moved) *moved += static_cast<int>(rows.size());
    for (; !rows.empty() && iterations < max_iterations; ++iterations) {
        push_to_distance(contacts, distance, rows, x);
        proximity.query_rows(x, rows, boundary, contacts, StepEnd::end, limits);
        keep_too_close(contacts, distance, rows);
    }
    return iterations;
}

ResolveReport resolve_penetration(Proximity& proximity, const Boundary& boundary, double distance,
                                  Points& x, SurfaceContacts& contacts, int max_iterations,
                                  const QueryLimits& limits) {
    ResolveReport report;
    if (boundary.obstacles.empty()) return report;
    proximity.query(x, boundary, contacts, StepEnd::end, limits);
    report.max_depth_before = max_depth(contacts.distance);
    std::vector<int> rows(static_cast<size_t>(x.rows()));
    std::iota(rows.begin(), rows.end(), 0);
    report.iterations = push_out_rows(proximity, boundary, distance, max_iterations, rows, x,
                                      contacts, &report.moved, limits);
    report.max_depth_after = max_depth(contacts.distance);
    return report;
}

ResolveReport resolve_penetration(Proximity& proximity, const Boundary& boundary, double distance,
                                  Points& x, int max_iterations) {
    SurfaceContacts contacts;
    return resolve_penetration(proximity, boundary, distance, x, contacts, max_iterations);
}

}  // namespace cloth
