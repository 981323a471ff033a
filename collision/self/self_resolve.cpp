#include "collision/self/self_resolve.h"

#include <algorithm>
#include <cmath>

#include "collision/proximity/direction.h"
#include "collision/response/resolve.h"
#include "data/core/garment_pieces.h"

namespace cloth {
namespace {

constexpr int sweeps = 40;              // of PlanePush in each round
constexpr double most = 3.0;            // see PlanePush::solve
constexpr double growth = 0.03;         // of edges near what is pushed, as in ContactProjection
constexpr double hold_distance = 1e-2;  // m: vertices further from obstacles, or from the limits of
                                        // their goals, need no holding
constexpr double gap_share = 0.25;      // of the thickness, at which cloth is left
constexpr int zone_rounds = 50;         // each joins zones that touch, so they end
constexpr int turning_rounds = 5;       // of these; elements in a turn whose distance is next to
                                        // nothing cannot be told from elements that touch
constexpr double torn = 1.5;            // times its rest length, of an edge that
constexpr double torn_growth = 1.2;     // was drawn out by so much more than the step would have

VectorX inverses(const VectorX& masses, const std::vector<char>& held) {
    VectorX inverse = masses.cwiseInverse();
    for (size_t i = 0; i < held.size(); ++i)
        if (held[i]) inverse[static_cast<Eigen::Index>(i)] = 0.0;
    return inverse;
}

}  // namespace

SelfResolver::SelfResolver(const Garment& garment, const SelfContactSettings& settings)
    : SelfResolver(garment, settings, garment.masses(), {}) {
}

SelfResolver::SelfResolver(const Garment& garment, const SelfContactSettings& settings,
                           const VectorX& masses, const FaceParts& parts)
    : m_settings(settings),
      m_crossings(garment, parts),
      m_push(inverses(masses, garment.is_held())),
      m_guard(garment, growth),
      m_zones(garment, masses),
      m_rest(garment.rest().vertices),
      m_edges(garment.edges()),
      m_piece(garment_pieces(garment)),
      m_free_masses(garment.pins().empty() ? masses : VectorX()),
      m_held(static_cast<size_t>(garment.vertex_count()), 0) {
    check_self_contact(settings);
}

SelfResolveReport SelfResolver::resolve(const Points& x0, const SurfaceContacts& contacts,
                                        double distance, Points& x, bool may_pass,
                                        const std::vector<VertexGoal>& goals,
                                        const std::vector<char>& passing) {
    SelfResolveReport report;
    m_moved.clear();
    m_pairs.clear();
    if (m_settings.rounds == 0) return report;
    const auto count_crossings = [&] {
        return static_cast<int>(m_crossings.find(x0, x, m_settings.threads, passing).size());
    };
    report.left = report.crossings = count_crossings();
    report.keeps_untangled = report.left == 0 && m_crossings.passed_over_none();
    if (report.left == 0) return report;
    m_before = x;
    m_guard.begin_frame(x);
    while (report.left > 0 && report.rounds < m_settings.rounds) {
        ++report.rounds;
        m_pairs.insert(m_pairs.end(), m_crossings.found().begin(), m_crossings.found().end());
        push(contacts, distance, goals, x);
        report.left = count_crossings();
    }
    if (report.left > 0) {
        m_zones.begin(x);
        for (int round = 0; report.left > 0 && round < zone_rounds; ++round) {
            m_zones.merge(m_crossings.found());
            m_zones.apply(x0, round < turning_rounds, x);
            report.left = count_crossings();
        }
        report.rigid = m_zones.vertex_count();
    }
    if (may_pass && release_torn(contacts, x)) report.left = count_crossings();
    report.keeps_untangled = report.left == 0 && m_crossings.passed_over_none();
    note_moved(x);
    return report;
}

/// Half of what elements of one piece are apart at rest, where that is less: a fine mesh must not
/// be blown up.
double SelfResolver::gap(const ElementPair& elements) const {
    const double wanted = gap_share * m_settings.thickness;
    if (m_piece[static_cast<size_t>(elements.vertex[0])] !=
        m_piece[static_cast<size_t>(elements.vertex[3])])
        return wanted;
    const double rest =
        std::sqrt(closest_points(elements.edges, corners_of(elements, m_rest)).squared);
    return std::min(wanted, 0.5 * rest);
}

void SelfResolver::push(const SurfaceContacts& contacts, double distance,
                        const std::vector<VertexGoal>& goals, Points& x) {
    m_push.clear();
    for (const SelfPair& pair : m_pairs)
        m_push.add_pair(pair.elements.vertex, pair.weight, pair.normal, gap(pair.elements));
    hold_vertices(contacts, distance);
    m_guard.add_planes(x, m_push);
    hold_at_goals(goals, x);
    m_push.solve(sweeps, most, x);
}

/// Planes that keep the vertices of the pairs outside of obstacles.
void SelfResolver::hold_vertices(const SurfaceContacts& contacts, double distance) {
    if (contacts.obstacle.empty()) return;
    std::fill(m_held.begin(), m_held.end(), 0);
    for (const SelfPair& pair : m_pairs)
        for (const int i : pair.elements.vertex) {
            char& held = m_held[static_cast<size_t>(i)];
            if (held || !contacts.has(i) || !(contacts.distance[i] < hold_distance)) continue;
            held = 1;
            const Vec3 normal = outward(contacts, i, m_before);
            hold(i, normal, normal.dot(contacts.point1.row(i)) + distance);
        }
}

/// Planes that keep whatever is pushed within the limits of its goals. Left to a projection
/// afterwards, what that brings back would pass through what it was pushed out of. Each pair has
/// its own, so that pairs do not outweigh them.
void SelfResolver::hold_at_goals(const std::vector<VertexGoal>& goals, const Points& x) {
    if (goals.empty()) return;
    std::fill(m_held.begin(), m_held.end(), 0);
    m_push.mark_vertices(m_held);
    m_goal.assign(m_held.size(), nullptr);
    for (const VertexGoal& goal : goals) {
        const auto i = static_cast<size_t>(goal.vertex);
        m_goal[i] = &goal;
        const Vec3 at = x.row(goal.vertex);
        if (m_held[i]) hold_at_goal(goal, at, (at - goal.place).stableNormalized());
    }
    for (const SelfPair& pair : m_pairs)
        for (size_t k = 0; k < 4; ++k) {
            const int i = pair.elements.vertex[k];
            const VertexGoal* goal = m_goal[static_cast<size_t>(i)];
            if (goal && pair.weight[k] != 0.0)
                hold_at_goal(*goal, x.row(i), std::copysign(1.0, pair.weight[k]) * pair.normal);
        }
}

/// @param along  where the vertex may be pushed to, of unit length or zero
void SelfResolver::hold_at_goal(const VertexGoal& goal, const Vec3& x, const Vec3& along) {
    const Vec3 away = x - goal.place;
    if (goal.max_distance - away.dot(along) < hold_distance && !along.isZero(0.0))
        hold(goal.vertex, -along, -along.dot(goal.place) - goal.max_distance);
    if (goal.backstop + away.dot(goal.normal) < hold_distance && !goal.normal.isZero(0.0))
        hold(goal.vertex, goal.normal, goal.normal.dot(goal.place) - goal.backstop);
}

void SelfResolver::hold(int vertex, const Vec3& normal, double height) {
    m_push.add({vertex, vertex, vertex}, {1.0, 0.0, 0.0}, normal, height);
}

/// Puts the ends of torn edges back where the step would have ended; the whole follows, so that
/// cloth that nothing holds keeps its momentum. Returns whether there are any.
bool SelfResolver::release_torn(const SurfaceContacts& contacts, Points& x) const {
    const auto length = [](const std::array<int, 2>& edge, const Points& points) {
        return (points.row(edge[0]) - points.row(edge[1])).norm();
    };
    bool any = false, found = true;
    while (found) {  // what was put back may tear its neighbours
        found = false;
        for (const auto& edge : m_edges) {
            const double now = length(edge, x);
            if (!(now > torn * length(edge, m_rest)) ||
                !(now > torn_growth * length(edge, m_before)))
                continue;
            for (const int i : edge) x.row(i) = m_before.row(i);
            found = any = true;
        }
    }
    if (any && contacts.obstacle.empty() && m_free_masses.size() > 0)
        x.rowwise() -= (m_free_masses.transpose() * (x - m_before)) / m_free_masses.sum();
    return any;
}

void SelfResolver::note_moved(const Points& x) {
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        if (x.row(i) != m_before.row(i)) m_moved.push_back(static_cast<int>(i));
}

}  // namespace cloth
