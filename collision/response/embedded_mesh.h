#pragma once

#include <vector>

#include "collision/response/resolve.h"
#include "data/core/follower.h"
#include "data/core/mesh_embedding.h"

namespace cloth {

struct EmbeddedMeshSettings {
    MeshEmbeddingSettings embedding;
    double distance = 1e-3;  ///< of fine vertices from obstacles (m), 0 to 5e-3
    double deepest = 0.02;   ///< fine vertices that are deeper inside stay there (m), 0.01 to 0.1;
                             ///< larger costs time
    int threads = 0;         ///< of the queries, see ProximitySettings
};

/// A fine mesh to be drawn that follows the coarse one that is simulated, and stays out of the
/// obstacles:
///
///     EmbeddedMesh shirt(garment.rest(), fine);
///     stepper.step(boundary, dt, state);
///     shirt.follow(state.x, boundary, stepper.ignored_limbs());
///     draw(shirt.vertices(), shirt.normals(), shirt.faces());
///
/// It has no motion of its own: wrinkles finer than the coarse edges are not there.
class EmbeddedMesh : public Follower {
 public:
    /// @param simulated  at rest (m)
    /// @param fine       in the same place (m)
    /// @throws ArgumentError if a setting is out of range, or as MeshEmbedding does
    EmbeddedMesh(const TriMesh& simulated, const TriMesh& fine,
                 const EmbeddedMeshSettings& settings = {});

    /// Moves the fine mesh to where the simulated vertices are, and out of the obstacles at the end
    /// of the step. Where they are not finite it stays as it was.
    /// @param ignored  limbs that each simulated vertex ignores (|V|), see
    ///                 Stepper::ignored_limbs(), or empty. A fine vertex ignores those of the
    ///                 vertices around it; Boundary::ignored_limbs does not count
    /// @throws ArgumentError if the number of vertices is not that of the simulated mesh
    ResolveReport follow(const Points& simulated, const Boundary& boundary,
                         const std::vector<LimbSet>& ignored = {});

    Eigen::Index simulated_size() const override { return m_embedding.coarse_size(); }
    void show(const Points& simulated, const Boundary& boundary,
              const std::vector<LimbSet>& ignored) override {
        follow(simulated, boundary, ignored);
    }

    const Points& vertices() const { return m_x; }  ///< N x 3 (m); at first those at rest
    const Faces& faces() const { return m_faces; }
    /// Unit normals of the vertices (N x 3).
    Points normals() const { return vertex_normals(m_x, m_faces); }
    const MeshEmbedding& embedding() const { return m_embedding; }

 private:
    void take_ignored(const std::vector<LimbSet>& ignored);

    EmbeddedMeshSettings m_settings;
    MeshEmbedding m_embedding;
    Faces m_faces;
    Proximity m_proximity;
    SurfaceContacts m_contacts;
    std::vector<LimbSet> m_ignored;  ///< N, or empty
    Points m_x, m_next;
};

}  // namespace cloth
