#include "collision/response/pinch_sides.h"

#include <algorithm>

#include "collision/proximity/direction.h"
#include "collision/response/resolve.h"

namespace cloth {

constexpr double opposite_skins = -0.3;  // cosine of skins that face away from each other
constexpr double slab = -0.9;            // cosine of skins between which there is no ridge
constexpr double far_away = 2e-2;        // m: skins further from a vertex do not count
constexpr double drawn_weight = 1000.0;  // vertices that a vertex which was drawn counts for

PinchSides::PinchSides(Eigen::Index vertex_count)
    : m_parent(static_cast<size_t>(vertex_count), 0),
      m_drawn(static_cast<size_t>(vertex_count), 0),
      m_counted(static_cast<size_t>(vertex_count), 0),
      m_reference(Points::Zero(vertex_count, 3)),
      m_balance(VectorX::Zero(vertex_count)) {
}

void PinchSides::begin_frame() {
    std::fill(m_drawn.begin(), m_drawn.end(), 0);
}

static bool stands_near(const SurfaceContacts& contacts, int vertex) {
    return contacts.has(vertex) && contacts.distance[vertex] < far_away;
}

bool PinchSides::is_pinched(const SurfaceSamples& samples, int sample, const Points& x,
                            const SurfaceContacts& contacts) {
    const Vec3 way_out = samples.way_out(sample);
    const SurfaceSamples::Corners at = samples.corners(sample);
    for (int k = 0; k < at.count(); ++k) {
        const int i = at.vertex[static_cast<size_t>(k)];
        if (stands_near(contacts, i) && outward(contacts, i, x).dot(way_out) < opposite_skins)
            return true;
    }
    return false;
}

bool PinchSides::add_ridge_plane(const SurfaceSamples& samples, int sample, const Points& x,
                                 const SurfaceContacts& contacts, double allowed_depth,
                                 PlanePush& push) {
    const SurfaceSamples::Corners at = samples.corners(sample);
    Vec3 ridge = Vec3::Zero();  // between the two skins that part most
    double cosine = 1.0;
    for (int k = 0; k < at.count(); ++k)
        for (int l = 0; l < k; ++l) {
            const int a = at.vertex[static_cast<size_t>(k)], b = at.vertex[static_cast<size_t>(l)];
            if (!stands_near(contacts, a) || !stands_near(contacts, b)) continue;
            const Vec3 first = outward(contacts, a, x), second = outward(contacts, b, x);
            if (first.dot(second) < cosine) cosine = first.dot(second), ridge = first + second;
        }
    if (!(cosine > slab) || cosine == 1.0) return false;
    ridge.normalize();
    const double along = samples.way_out(sample).dot(ridge);
    const double depth = -samples.contacts().distance[sample] - allowed_depth;
    const double height = samples.position(sample).dot(ridge);
    push.add(at.vertex, at.weight, ridge, height + depth / std::max(along, 0.5));
    return true;
}

int PinchSides::root(int vertex) {
    while (m_parent[static_cast<size_t>(vertex)] != vertex)
        vertex = m_parent[static_cast<size_t>(vertex)];
    return vertex;
}

/// Joins samples that share a vertex to patches.
void PinchSides::connect(const SurfaceSamples& samples, const std::vector<int>& pinched) {
    for (const int sample : pinched)
        for (const int i : samples.corners(sample).vertex) {
            m_parent[static_cast<size_t>(i)] = i;
            m_counted[static_cast<size_t>(i)] = 0;
            m_reference.row(i).setZero();
            m_balance[i] = 0.0;
        }
    for (const int sample : pinched) {
        const auto vertices = samples.corners(sample).vertex;
        for (const size_t k : {1, 2}) {
            const int a = root(vertices[0]), b = root(vertices[k]);
            m_parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
        }
    }
}

void PinchSides::count_sides(const SurfaceSamples& samples, const std::vector<int>& pinched,
                             const Points& x, const SurfaceContacts& contacts) {
    for (const int sample : pinched)
        for (const int i : samples.corners(sample).vertex) {
            if (m_counted[static_cast<size_t>(i)] || !stands_near(contacts, i)) continue;
            m_counted[static_cast<size_t>(i)] = 1;
            const int patch = root(i);
            const Vec3 normal = outward(contacts, i, x);
            if (m_reference.row(patch).isZero(0.0)) m_reference.row(patch) = normal;
            const double side = m_reference.row(patch).dot(normal) >= 0.0 ? 1.0 : -1.0;
            m_balance[patch] += side * (m_drawn[static_cast<size_t>(i)] ? drawn_weight : 1.0);
        }
}

void PinchSides::add_planes(const SurfaceSamples& samples, const std::vector<int>& pinched,
                            const Points& x, const SurfaceContacts& contacts, double distance,
                            double allowed_depth, PlanePush& push, std::vector<char>& drawn) {
    connect(samples, pinched);
    count_sides(samples, pinched, x, contacts);
    for (const int sample : pinched) {
        const SurfaceSamples::Corners at = samples.corners(sample);
        const int patch = root(at.vertex[0]);
        const Vec3 side = m_reference.row(patch) * (m_balance[patch] >= 0.0 ? 1.0 : -1.0);
        // the skin of that side: the one that faces it most squarely
        Vec3 normal = samples.way_out(sample), point = samples.contacts().point1.row(sample);
        for (int k = 0; k < at.count(); ++k) {
            const int i = at.vertex[static_cast<size_t>(k)];
            if (!stands_near(contacts, i)) continue;
            const Vec3 other = outward(contacts, i, x);
            if (other.dot(side) > normal.dot(side)) normal = other, point = contacts.point1.row(i);
        }
        push.add(at.vertex, at.weight, normal, normal.dot(point) - allowed_depth);
        for (int k = 0; k < at.count(); ++k) {
            const int i = at.vertex[static_cast<size_t>(k)];
            if (!stands_near(contacts, i) || outward(contacts, i, x).dot(normal) >= opposite_skins)
                continue;
            push.add({i, i, i}, {1.0, 0.0, 0.0}, normal, normal.dot(point) + distance);
            m_drawn[static_cast<size_t>(i)] = drawn[static_cast<size_t>(i)] = 1;
        }
    }
}

}  // namespace cloth
