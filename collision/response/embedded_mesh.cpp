#include "collision/response/embedded_mesh.h"

#include <algorithm>
#include <utility>

#include "data/core/check_range.h"

namespace cloth {

namespace {

constexpr int kPushes = 3;  // of a vertex that comes too near to another surface

const EmbeddedMeshSettings& checked(const EmbeddedMeshSettings& settings) {
    check_range("EmbeddedMeshSettings.distance", settings.distance, 0.0, 5e-3);
    check_range("EmbeddedMeshSettings.deepest", settings.deepest, 0.01, 0.1);
    return settings;
}

}  // namespace

EmbeddedMesh::EmbeddedMesh(const TriMesh& simulated, const TriMesh& fine,
                           const EmbeddedMeshSettings& settings)
    : m_settings(checked(settings)),
      m_embedding(simulated, fine, settings.embedding),
      m_faces(fine.faces),
      m_proximity({settings.deepest, settings.threads}),
      m_x(fine.vertices) {
}

/// Passing over a limb too many shows cloth inside it, where the simulated cloth is, too. One too
/// few pushes cloth to the limb's far side.
void EmbeddedMesh::take_ignored(const std::vector<LimbSet>& ignored) {
    m_ignored.clear();
    if (ignored.size() != static_cast<size_t>(m_embedding.coarse_size())) return;
    if (std::all_of(ignored.begin(), ignored.end(), [](LimbSet set) { return set == 0; })) return;
    m_ignored.assign(static_cast<size_t>(m_embedding.size()), 0);
    for (Eigen::Index i = 0; i < m_embedding.size(); ++i)
        for (const int corner : m_embedding.corners(i))
            m_ignored[static_cast<size_t>(i)] |= ignored[static_cast<size_t>(corner)];
}

ResolveReport EmbeddedMesh::follow(const Points& simulated, const Boundary& boundary,
                                   const std::vector<LimbSet>& ignored) {
    m_embedding.positions(simulated, m_next);
    if (!m_next.allFinite()) return {};
    std::swap(m_x, m_next);
    take_ignored(ignored);
    QueryLimits limits;
    limits.ignored = &m_ignored;
    return resolve_penetration(m_proximity, boundary, m_settings.distance, m_x, m_contacts, kPushes,
                               limits);
}

}  // namespace cloth
