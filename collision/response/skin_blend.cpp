#include "collision/response/skin_blend.h"

#include <algorithm>

#include "data/core/check_range.h"

namespace cloth {

namespace {

constexpr int kPushesToSkin = 4;  // of a vertex that comes too near to another surface
constexpr double kOut = 1e-7;     // m: what rounding leaves of a push

SkinBlendSettings checked(const SkinBlendSettings& settings) {
    settings.check();
    return settings;
}

}  // namespace

void SkinBlendSettings::check() const {
    check_range("SkinBlendSettings.distance", distance, 0.0, 5e-3);
    check_range("SkinBlendSettings.deepest", deepest, 0.01, 1.0);
}

SkinBlend::SkinBlend(const SkinBlendSettings& settings)
    : m_settings(checked(settings)), m_proximity({settings.deepest, settings.threads}) {
}

void SkinBlend::fade_to(double weight, double seconds) {
    check_range("fade_to(): weight", weight, 0.0, 1.0);
    check_range("fade_to(): seconds", seconds, 0.0, 1e6);
    m_target = weight;
    m_left = m_weight == weight ? 0.0 : seconds;
    if (m_left == 0.0) m_weight = weight;
}

void SkinBlend::advance(double dt) {
    if (!is_fading() || !(dt > 0.0)) return;
    if (dt >= m_left) {
        m_weight = m_target;
        m_left = 0.0;
        return;
    }
    m_weight += (m_target - m_weight) * (dt / m_left);
    m_left -= dt;
}

ResolveReport SkinBlend::follow(const Points& simulated, const Points& skinned,
                                const Boundary& boundary, const std::vector<LimbSet>& ignored) {
    if (!simulated.allFinite()) return {};
    const bool fits = skinned.rows() == simulated.rows() && skinned.allFinite();
    if (m_weight == 0.0 || !fits) {
        m_x = simulated;
        return {};
    }
    m_x = (1.0 - m_weight) * simulated + m_weight * skinned;
    QueryLimits limits;
    if (ignored.size() == static_cast<size_t>(m_x.rows())) limits.ignored = &ignored;
    m_contacts.clear();
    ResolveReport report = resolve_penetration(m_proximity, boundary, m_settings.distance, m_x,
                                               m_contacts, kPushesToSkin, limits);
    if (report.max_depth_after <= kOut) return report;
    report.max_depth_after = 0.0;
    for (Eigen::Index i = 0; i < m_x.rows(); ++i)
        if (m_contacts.has(i) && m_contacts.distance[i] < -kOut) m_x.row(i) = simulated.row(i);
    return report;
}

}  // namespace cloth
