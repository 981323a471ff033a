#pragma once

#include <memory>
#include <vector>

#include "collision/proximity/closest_face_tree.h"
#include "collision/proximity/proximity.h"

namespace cloth {

/// Closest point of a mesh with the sign of its distance.
struct SurfaceHit {
    int face = -1;                    ///< -1: none within the radius
    Vec3 barycentric = Vec3::Zero();  ///< of the closest point in that face
    double distance = 0.0;            ///< signed distance (m), negative inside
    LimbSet limbs = 0;  ///< of all faces that share the closest feature (face, edge or vertex)
};

/// Which faces meet at each vertex. Vertices of open edges that coincide (to the bit) in the first
/// pose count as one: meshes split along seams, and unindexed triangles, are closed by that.
class VertexFaces {
 public:
    VertexFaces(const Points& vertices, const Faces& faces);

    int welded(int vertex) const { return m_weld[size_t(vertex)]; }
    /// The faces at a vertex: [begin, end), ascending.
    const int* begin(int vertex) const { return m_faces.data() + m_first[size_t(welded(vertex))]; }
    const int* end(int vertex) const {
        return m_faces.data() + m_first[size_t(welded(vertex)) + 1];
    }

 private:
    std::vector<int> m_weld;   ///< |V|: representative vertex
    std::vector<int> m_first;  ///< |V| + 1
    std::vector<int> m_faces;  ///< faces by representative vertex, ascending
};

/// A moving mesh that answers signed closest-point queries. Copies share what does not move.
///
/// The sign comes from the pseudonormal of the closest feature: the face's normal, the sum of the
/// normals of the faces at an edge, or their sum weighted by angle at a vertex (Baerentzen and
/// Aanaes 2005). Of the faces that share the feature, the one that the query point is most squarely
/// in front of (or behind, inside) is reported: rounding cannot make the normal jump between them.
class MeshSurface {
 public:
    /// @param limbs  |F|: limb of each face, or null
    MeshSurface(std::shared_ptr<const Faces> faces, const Points& vertices, double radius,
                const std::vector<std::uint8_t>* limbs = nullptr);

    void refit(const Points& vertices) { m_tree.refit(vertices); }

    /// @param ignored  limbs that are passed over
    SurfaceHit closest(const Vec3& q, double radius, int hint, ClosestFaceTree::Stack& stack,
                       LimbSet ignored = 0) const;

    /// The same for 1 to ClosestFaceTree::packet points, faster where they are near each other.
    void closest(const ClosestFaceTree::Query* queries, int count, ClosestFaceTree::Stack& stack,
                 SurfaceHit* hits) const;

    /// The part of the mesh that lies over a point of a face, along its normal; nothing, if what
    /// the ray along the normal meets first (within `length`) is seen from outside.
    /// @param ignored  limbs that the ray passes through
    std::optional<Cover> cover(const Vec3& point, int face, double length,
                               ClosestFaceTree::Stack& stack, LimbSet ignored = 0) const;

    const std::shared_ptr<const Faces>& faces() const { return m_faces; }
    const Points& vertices() const { return m_tree.vertices(); }

 private:
    Vec3 normal(int face) const;
    SurfaceHit with_sign(const FaceHit& hit, const Vec3& q, LimbSet ignored) const;
    SurfaceHit on_face(const FaceHit& hit, const Vec3& away) const;
    SurfaceHit on_edge_or_vertex(const FaceHit& hit, const Vec3& away, LimbSet ignored) const;
    /// The corner (0 to 2) of a face that is this vertex, or coincides with it across a seam; -1.
    int corner_at(int face, int vertex) const;

    std::shared_ptr<const Faces> m_faces;
    ClosestFaceTree m_tree;
    std::shared_ptr<const VertexFaces> m_vertex_faces;
};

}  // namespace cloth
