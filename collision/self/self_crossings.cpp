#include "collision/self/self_crossings.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>
#include <utility>

#include "collision/geometry/gather_in_order.h"

namespace cloth {
namespace {

constexpr double touching = 1e-6;  // m: nearer than this is a touch
constexpr int max_advances = 200;  // elements that slide closely along each other count as touching

/// Longest way (m) that two points of the elements can come nearer in the whole step; the mean of
/// the motions, which changes no distance, is taken off.
double most_approach(bool edges, std::array<Vec3, 4>& motion) {
    const Vec3 mean = 0.25 * (motion[0] + motion[1] + motion[2] + motion[3]);
    for (Vec3& part : motion) part -= mean;
    const double a = motion[0].squaredNorm(), b = motion[1].squaredNorm();
    const double c = motion[2].squaredNorm(), d = motion[3].squaredNorm();
    return edges ? std::sqrt(std::max(a, b)) + std::sqrt(std::max(c, d))
                 : std::sqrt(a) + std::sqrt(std::max({b, c, d}));
}

}  // namespace

bool crosses(const ElementPair& elements, const Points& x0, const Points& motion, SelfPair& pair) {
    std::array<Vec3, 4> x = corners_of(elements, x0), moves = corners_of(elements, motion);
    const double approach = most_approach(elements.edges, moves);
    ClosestPoints points = closest_points(elements.edges, x);
    double distance = std::sqrt(points.squared);
    if (!(distance > 0.0) || distance > approach) return false;
    const double touch = std::min(touching, 0.1 * distance);
    double progress = 0.0;
    for (int k = 0; k < max_advances; ++k) {
        const double advance = (distance - 0.5 * touch) / approach;
        progress += advance;
        if (progress > 1.0) return false;
        for (size_t i = 0; i < 4; ++i) x[i] += advance * moves[i];
        points = closest_points(elements.edges, x);
        distance = std::sqrt(points.squared);
        if (distance <= touch) break;
    }
    if (!(distance > 0.0)) return false;
    pair = {elements, points.weight, points.offset / distance, distance};
    return true;
}

SelfCrossings::SelfCrossings(const Garment& garment, FaceParts parts)
    : m_groups(garment, ElementGroups::Which::near), m_parts_of_faces(std::move(parts)) {
}

const std::vector<SelfPair>& SelfCrossings::find(const Points& x0, const Points& x1, int threads,
                                                 const std::vector<char>& passing) {
    const bool goes_on = same_points(x0, m_x0) && passing == m_passing;
    if (goes_on && same_points(x1, m_x1)) return m_found;
    m_motion = x1 - x0;
    if (goes_on)
        find_changed(x0, x1, threads);
    else
        find_all(x0, threads, passing);
    m_x1 = x1;
    return m_found;
}

void SelfCrossings::find_all(const Points& x0, int threads, const std::vector<char>& passing) {
    m_x0 = x0;
    m_passing = passing;
    m_passed_over_none = passing.empty();
    m_groups.find(x0, m_motion, touching, threads);
    m_changed.assign(static_cast<size_t>(x0.rows()), 1);
    m_found.clear();
    add_changed(x0, threads);
}

/// What none of whose vertices has moved is what it was.
void SelfCrossings::find_changed(const Points& x0, const Points& x1, int threads) {
    for (Eigen::Index i = 0; i < x1.rows(); ++i)
        m_changed[static_cast<size_t>(i)] = x1.row(i) != m_x1.row(i) ? 1 : 0;
    m_groups.find_changed(x0, m_motion, m_changed, touching, threads);
    const auto has_changed = [&](const SelfPair& pair) {
        return has_any(pair.elements, m_changed);
    };
    m_found.erase(std::remove_if(m_found.begin(), m_found.end(), has_changed), m_found.end());
    add_changed(x0, threads);
}

/// Those of which a vertex has changed, in an order that says nothing of what was found before.
void SelfCrossings::add_changed(const Points& x0, int threads) {
    std::atomic<bool> passed_over = false;
    const auto find = [&](int k, std::vector<SelfPair>& out) {
        m_groups.visit(k, [&](const ElementPair& elements, int f, int g) {
            SelfPair pair;
            if (!has_any(elements, m_changed) || m_parts_of_faces.same(f, g) ||
                has_any(elements, m_passing))
                return;
            if (crosses(elements, x0, m_motion, pair))
                out.push_back(pair);
            else if (closest_points(elements.edges, corners_of(elements, x0)).squared == 0.0)
                passed_over.store(true, std::memory_order_relaxed);
        });
    };
    gather_each_in_order(m_groups.found(), m_groups.worthwhile(threads), m_parts, m_new, find,
                         ElementGroups::pairs_at_once);
    if (passed_over) m_passed_over_none = false;
    m_found.insert(m_found.end(), m_new.begin(), m_new.end());
    std::sort(m_found.begin(), m_found.end(), [](const SelfPair& a, const SelfPair& b) {
        return std::tie(a.elements.edges, a.elements.element) <
               std::tie(b.elements.edges, b.elements.element);
    });
}

}  // namespace cloth
