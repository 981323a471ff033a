#include "collision/response/contact_projection.h"

#include <limits>

#include "collision/proximity/direction.h"
#include "data/core/check_range.h"

namespace cloth {
namespace {

constexpr int vertex_iterations = 3;    // of push_out_rows
constexpr double slack = 1e-4;          // m: samples lifted to within this are not lifted again
constexpr double same_way = 0.5;        // least cosine of the angle between ways out
constexpr double hold_distance = 1e-2;  // m: vertices further outside need no holding

const ContactProjectionSettings& checked(const ContactProjectionSettings& settings) {
    check_range("ContactProjectionSettings.allowed_depth", settings.allowed_depth, 0.0, 5e-3);
    check_range("ContactProjectionSettings.iterations", settings.iterations, 0, 100);
    check_range("ContactProjectionSettings.sweeps", settings.sweeps, 1, 1000);
    check_range("ContactProjectionSettings.most", settings.most, 1.0, 10.0);
    check_range("ContactProjectionSettings.growth", settings.growth, 0.01, 1.0);
    return settings;
}

}  // namespace

ContactProjection::ContactProjection(const Garment& garment,
                                     const ContactProjectionSettings& settings)
    : m_settings(checked(settings)),
      m_samples(garment),
      m_sides(garment.vertex_count()),
      m_push(garment.inverse_masses()),
      m_guard(garment, settings.growth),
      m_pinned(garment.is_pinned()),
      m_changed(m_pinned.size(), 0),
      m_held(m_pinned.size(), 0),
      m_best(Points::Zero(garment.vertex_count(), 3)) {
    for (size_t i = 0; i < m_pinned.size(); ++i)
        if (!m_pinned[i]) m_free.push_back(static_cast<int>(i));
    m_rows.reserve(m_pinned.size());
    m_pinched.reserve(static_cast<size_t>(garment.face_count()) + garment.edges().size());
}

double ContactProjection::depth_of_free(const SurfaceContacts& contacts) const {
    double depth = 0.0;
    for (const int i : m_free) depth = std::max(depth, -contacts.distance[i]);
    return depth;
}

ResolveReport ContactProjection::resolve(Proximity& proximity, const Boundary& boundary,
                                         double distance, Points& x, SurfaceContacts& contacts,
                                         const WayIn& way_in) {
    ResolveReport report;
    if (boundary.obstacles.empty()) return report;
    proximity.query(x, boundary, contacts, StepEnd::end);
    report.max_depth_before = depth_of_free(contacts);
    m_rows = m_free;
    report.iterations = push_out_rows(proximity, boundary, distance, vertex_iterations, m_rows, x,
                                      contacts, &report.moved);
    if (m_surface && m_settings.iterations > 0)
        resolve_surface(proximity, boundary, distance, x, contacts, way_in, report);
    report.max_depth_after = depth_of_free(contacts);
    return report;
}

void ContactProjection::resolve_surface(Proximity& proximity, const Boundary& boundary,
                                        double distance, Points& x, SurfaceContacts& contacts,
                                        const WayIn& way_in, ResolveReport& report) {
    const double allowed = m_settings.allowed_depth;
    m_samples.find_deep(proximity, boundary, x, contacts, allowed, nullptr);
    report.max_surface_depth_before = report.max_surface_depth_after = m_samples.max_depth();
    if (m_samples.deep().empty()) return;
    m_sides.begin_frame();
    m_guard.begin_frame(x);
    double least = std::numeric_limits<double>::infinity();
    const auto keep_best = [&] {
        const double depth = std::max(m_samples.max_depth(), depth_of_free(contacts));
        const double cost = depth + m_guard.excess(x);
        if (!(cost < least)) return;
        least = cost;
        m_best = x;
        report.max_surface_depth_after = m_samples.max_depth();
    };
    keep_best();
    while (!m_samples.deep().empty() && report.surface_iterations < m_settings.iterations) {
        ++report.surface_iterations;
        push_samples(distance, x, contacts, way_in);
        push_vertices(proximity, boundary, distance, x, contacts);
        m_samples.find_deep(proximity, boundary, x, contacts, allowed + slack, &m_changed);
        keep_best();
    }
    if (x == m_best) return;
    x = m_best;
    proximity.query(x, boundary, contacts, StepEnd::end);
}

void ContactProjection::push_samples(double distance, Points& x, const SurfaceContacts& contacts,
                                     const WayIn& way_in) {
    m_push.clear();
    m_pinched.clear();
    std::fill(m_held.begin(), m_held.end(), 0);
    for (const int sample : m_samples.deep()) {
        if (way_in && push_back(sample, way_in)) continue;
        if (PinchSides::is_pinched(m_samples, sample, x, contacts)) {
            if (!PinchSides::add_ridge_plane(m_samples, sample, x, contacts,
                                             m_settings.allowed_depth, m_push))
                m_pinched.push_back(sample);
            continue;
        }
        const SurfaceSamples::Corners at = m_samples.corners(sample);
        const Vec3 normal = m_samples.way_out(sample);
        const double surface = m_samples.contacts().point1.row(sample).dot(normal);
        m_push.add(at.vertex, at.weight, normal, surface - m_settings.allowed_depth);
    }
    m_sides.add_planes(m_samples, m_pinched, x, contacts, distance, m_settings.allowed_depth,
                       m_push, m_held);
    hold_vertices(m_samples.deep(), distance, x, contacts);
    m_guard.add_planes(x, m_push);
    m_push.solve(m_settings.sweeps, m_settings.most, x);
}

/// The plane of where a sample went in, if the nearest way out is another.
bool ContactProjection::push_back(int sample, const WayIn& way_in) {
    const std::optional<HalfSpace> outside = way_in(m_samples, sample);
    if (!outside || outside->normal.dot(m_samples.way_out(sample)) > same_way ||
        outside->normal.dot(m_samples.position(sample)) > outside->height)
        return false;
    const SurfaceSamples::Corners at = m_samples.corners(sample);
    m_push.add(at.vertex, at.weight, outside->normal, outside->height - m_settings.allowed_depth);
    return true;
}

/// Planes that keep the vertices of samples outside; not for those that are drawn through a slab.
void ContactProjection::hold_vertices(const std::vector<int>& samples, double distance,
                                      const Points& x, const SurfaceContacts& contacts) {
    for (const int sample : samples)
        for (const int i : m_samples.corners(sample).vertex) {
            char& held = m_held[static_cast<size_t>(i)];
            if (held || !(contacts.distance[i] < hold_distance)) continue;
            held = 1;
            const Vec3 normal = outward(contacts, i, x);
            m_push.add({i, i, i}, {1.0, 0.0, 0.0}, normal,
                       normal.dot(contacts.point1.row(i)) + distance);
        }
}

void ContactProjection::push_vertices(Proximity& proximity, const Boundary& boundary,
                                      double distance, Points& x, SurfaceContacts& contacts) {
    std::fill(m_changed.begin(), m_changed.end(), 0);
    m_rows.clear();
    for (const int i : m_push.moved()) {
        if (m_pinned[static_cast<size_t>(i)]) continue;
        m_changed[static_cast<size_t>(i)] = 1;
        m_rows.push_back(i);
    }
    proximity.query_rows(x, m_rows, boundary, contacts, StepEnd::end);
    push_out_rows(proximity, boundary, distance, vertex_iterations, m_rows, x, contacts);
}

}  // namespace cloth
