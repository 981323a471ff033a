#pragma once

#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// Points that ride on a moving skin, such as the waistband of a skirt: each keeps its place in the
/// frame of the face that was nearest when it was bound.
///
///     const SkinBinding band({character.rest_vertices(), *character.faces()}, waistband);
///     const Points targets = band.positions(character.vertices(t));
class SkinBinding {
 public:
    /// @param skin    in the pose that the points were placed on (m)
    /// @param points  N x 3 (m)
    /// @throws ArgumentError if the skin has no face or a number is not finite
    SkinBinding(TriMesh skin, const Points& points);

    /// Where the points are (N x 3, m) when the skin's vertices are at `skin_vertices` (|V| x 3,
    /// m). Skin that moves rigidly takes them along rigidly.
    /// @throws ArgumentError if the number of vertices is not that of the skin
    Points positions(const Points& skin_vertices) const;

    /// How far the farthest point is from the skin that it was bound to (m).
    double farthest() const { return m_farthest; }

 private:
    struct Place {
        int face = 0;
        Vec3 weights = Vec3::Zero();  ///< of the face's corners
        Vec3 offset = Vec3::Zero();   ///< in the frame of the face (m)
    };
    Faces m_faces;
    Eigen::Index m_vertex_count;
    std::vector<Place> m_places;
    double m_farthest = 0.0;
};

}  // namespace cloth
