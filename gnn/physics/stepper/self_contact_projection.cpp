#include "gnn/physics/stepper/self_contact_projection.h"

#include <algorithm>

#include "collision/response/resolve.h"

namespace cloth {
namespace {

constexpr int passes = 3;             // layers, obstacles, layers, ...: layers have the last word
constexpr int goal_rounds = 4;        // of layers and goals in turn
constexpr double fair_move = 1e-6;    // m: goals that move vertices less leave the layers apart
constexpr double fair_depth = 1e-6;   // m: vertices less deep in an obstacle are at its surface
constexpr int vertex_iterations = 3;  // of push_out_rows

bool same(const Points& a, const Points& b) {
    return a.rows() == b.rows() && a == b;
}

}  // namespace

SelfContactProjection::SelfContactProjection(const Garment& garment,
                                             const SelfContactSettings& settings)
    : m_settings(settings), m_pinned(garment.is_pinned()) {
    check_self_contact(settings);
    if (settings.on())
        m_tools.emplace(
            Tools{SelfResolver(garment, settings), SelfTangles(garment), PassingVertices(garment)});
    if (settings.untangles()) m_untangling.emplace(garment, settings);
}

const std::vector<char>& SelfContactProjection::begin_step(const Points& x0,
                                                           const std::vector<char>& overlapped) {
    if (!m_tools) return overlapped;
    m_tools->passing.begin_step(x0, overlapped, tangles_at(x0));
    return m_tools->passing.unrepelled();
}

void SelfContactProjection::finish(const Points& x0, const Untangling::Surroundings& outside,
                                   Points& x, StepReport& report) {
    if (!m_tools || !x.allFinite()) return;
    m_last = {};
    const bool tangled = m_untangling && !same(x0, m_untangled);
    for (int round = 0; round < goal_rounds; ++round) {
        part_layers(x0, outside, tangled, x, report);
        m_next_untangled.resize(0, 3);
        if (m_last.keeps_untangled && same(x0, m_untangled)) m_next_untangled = x;
        outside.goals.resolve(outside.proximity, outside.boundary, outside.distance, x,
                              outside.contacts);
        if (outside.goals.last().max_move < fair_move) break;
    }
}

/// Layers and obstacles.
void SelfContactProjection::part_layers(const Points& x0, const Untangling::Surroundings& outside,
                                        bool tangled, Points& x, StepReport& report) {
    const auto& [boundary, proximity, goals, distance, contacts] = outside;
    const bool obstacles = !boundary.obstacles.empty();
    for (int pass = 0; pass < passes; ++pass) {
        const SelfResolveReport resolved =
            m_tools->resolver.resolve(x0, obstacles ? contacts : m_none, distance, x, tangled,
                                      goals.goals(), m_tools->passing.passing());
        m_last.crossings += resolved.crossings;
        m_last.rounds += resolved.rounds;
        m_last.rigid = std::max(m_last.rigid, resolved.rigid);
        m_last.left = resolved.left;
        m_last.keeps_untangled = resolved.keeps_untangled;
        if (m_tools->resolver.moved().empty() || !obstacles) break;
        m_rows = m_tools->resolver.moved();
        proximity.query_rows(x, m_rows, boundary, contacts, StepEnd::end);
        const double depth = depth_of_moved(contacts);
        report.max_penetration = std::max(report.max_penetration, depth);
        if (depth < fair_depth || pass + 1 == passes) break;
        push_out_rows(proximity, boundary, distance, vertex_iterations, m_rows, x, contacts);
    }
}

void SelfContactProjection::count_tangles(const Points& x, const std::vector<char>& overlapped,
                                          StepReport& report) {
    if (!m_tools || !x.allFinite()) return;
    if (same(x, m_next_untangled)) {
        m_untangled.swap(m_next_untangled);
        return;
    }
    report_tangles(m_tools->tangles.find(x, m_settings.threads), x, overlapped, report);
}

/// Null: there are none, or nobody untangles them. Looks for them only where x is not what the last
/// step ended with.
const std::vector<Tangle>* SelfContactProjection::tangles_at(const Points& x) {
    if (!m_untangling || same(x, m_untangled)) return nullptr;
    if (!same(x, m_tangled)) keep(m_tools->tangles.find(x, m_settings.threads), x);
    return m_left.empty() ? nullptr : &m_left;
}

void SelfContactProjection::untangle(const Untangling::Surroundings& outside, double dt,
                                     ClothState& state, StepReport& report) {
    if (!m_untangling || report.tangles == 0) return;
    if (m_untangling->run(outside, dt, state).moves == 0) return;
    const std::vector<char>& overlapped = outside.boundary.overlapped;
    report_tangles(overlapped.empty() ? m_untangling->tangles()
                                      : m_tools->tangles.find(state.x, m_settings.threads),
                   state.x, overlapped, report);
}

void SelfContactProjection::report_tangles(const std::vector<Tangle>& tangles, const Points& x,
                                           const std::vector<char>& overlapped,
                                           StepReport& report) {
    report.tangles = 0;
    report.first_tangle = Vec3::Zero();
    for (const Tangle& tangle : tangles) {
        if (m_tools->tangles.is_at(tangle, overlapped)) continue;
        if (report.tangles++ == 0) report.first_tangle = tangle.point;
    }
    keep(tangles, x);
}

void SelfContactProjection::keep(const std::vector<Tangle>& tangles, const Points& x) {
    m_left = tangles;
    if (tangles.empty())
        m_untangled = x;
    else
        m_untangled.resize(0, 3);
    m_tangled = x;
}

double SelfContactProjection::depth_of_moved(const SurfaceContacts& contacts) {
    double depth = 0.0;
    for (const int i : m_rows)
        if (!m_pinned[static_cast<size_t>(i)]) depth = std::max(depth, -contacts.distance[i]);
    return depth;
}

}  // namespace cloth
