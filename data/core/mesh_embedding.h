#pragma once

#include <array>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

struct MeshEmbeddingSettings {
    double reach = 0.03;  ///< no fine vertex is farther from the coarse mesh at rest (m), 1e-3 to 1
};

/// A fine mesh that follows a coarse one, such as the mesh that is drawn and the one that is
/// simulated. Each fine vertex keeps its place over the coarse face that is nearest at rest: in the
/// face, and above a curved surface through the corners of all faces. So the fine mesh is as smooth
/// as the coarse one's normals are. Motion that is rigid takes it along rigidly, and coarse
/// vertices at rest give it its own rest shape.
///
///     const MeshEmbedding embedding(garment.rest(), fine);
///     embedding.positions(state.x, x);
///
/// The curved surface is Phong tessellation: a point of a face is moved towards the weighted mean
/// of its projections into the corners' tangent planes (Boubekeur and Alexa, *Phong Tessellation*,
/// SIGGRAPH Asia 2008). Here it goes half of the way, not their 3/4: with exact normals that
/// reproduces surfaces of second order.
class MeshEmbedding {
 public:
    /// Where faces of several layers are near a vertex, those that face the same way as the fine
    /// mesh there come first.
    ///
    /// @param coarse  at rest (m)
    /// @param fine    in the same place (m)
    /// @throws ArgumentError if a mesh is unusable or a fine vertex is farther than the reach
    MeshEmbedding(const TriMesh& coarse, const TriMesh& fine,
                  const MeshEmbeddingSettings& settings = {});

    /// Where the fine vertices are (N x 3, m) when the coarse ones are at `coarse` (|V| x 3, m). A
    /// vertex over a face that has become a line or a point is on it.
    /// @throws ArgumentError if the number of coarse vertices is not that of the mesh
    void positions(const Points& coarse, Points& fine) const;

    /// Means of the corners' values, such as velocities (|V| x 3), by the places in the faces.
    /// @throws ArgumentError as positions()
    void interpolate(const Points& values, Points& result) const;

    Eigen::Index size() const { return static_cast<Eigen::Index>(m_places.size()); }
    Eigen::Index coarse_size() const { return m_coarse_size; }
    /// The coarse vertices around a fine one.
    std::array<int, 3> corners(Eigen::Index fine) const;
    /// Of the corners at its place in the face; they sum to 1.
    const Vec3& weights(Eigen::Index fine) const {
        return m_places[static_cast<size_t>(fine)].weights;
    }
    /// How far the farthest fine vertex is from the coarse mesh at rest (m).
    double farthest() const { return m_farthest; }

 private:
    struct Place {
        int face = 0;
        Vec3 weights = Vec3::Zero();  ///< of the face's corners
        Vec3 offset = Vec3::Zero();   ///< along two edges of the face (of their lengths) and along
                                      ///< the interpolated normal (m)
    };
    void check_size(const Points& values) const;

    Faces m_faces;
    Eigen::Index m_coarse_size;
    std::vector<Place> m_places;
    double m_farthest = 0.0;
};

}  // namespace cloth
