#include "data/body/skin_binding.h"

#include <algorithm>
#include <string>
#include <utility>

#include "data/core/errors.h"
#include "data/core/surface_distance.h"

namespace cloth {

namespace {

/// Columns: along the first edge of the face, its normal, and across both.
Eigen::Matrix3d face_frame(const Points& x, const Faces& faces, int face) {
    const Vec3 a = x.row(faces(face, 0)), b = x.row(faces(face, 1)), c = x.row(faces(face, 2));
    const Vec3 along = (b - a).normalized();
    const Vec3 normal = (b - a).cross(c - a).normalized();
    Eigen::Matrix3d frame;
    frame << along, normal, along.cross(normal);
    return frame;
}

Vec3 weighted_corners(const Points& x, const Faces& faces, int face, const Vec3& weights) {
    Vec3 p = Vec3::Zero();
    for (int c = 0; c < 3; ++c) p += weights[c] * x.row(faces(face, c)).transpose();
    return p;
}

}  // namespace

SkinBinding::SkinBinding(TriMesh skin, const Points& points)
    : m_faces(skin.faces), m_vertex_count(skin.vertices.rows()) {
    if (skin.faces.rows() == 0)
        throw ArgumentError("SkinBinding: skin", "it has no face", "give the character's surface");
    if (!skin.vertices.allFinite() || !points.allFinite())
        throw ArgumentError("SkinBinding", "a position is not finite",
                            "give finite positions in metres");
    const SurfaceDistance surface(std::move(skin));
    const Points& x = surface.surface().vertices;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const Vec3 p = points.row(i);
        const NearestPoint near = surface.nearest(p);
        const Eigen::Matrix3d frame = face_frame(x, m_faces, near.face);
        m_places.push_back({near.face, near.weights, frame.transpose() * (p - near.point)});
        m_farthest = std::max(m_farthest, (p - near.point).norm());
    }
}

Points SkinBinding::positions(const Points& skin_vertices) const {
    if (skin_vertices.rows() != m_vertex_count)
        throw ArgumentError("SkinBinding::positions",
                            "there are " + std::to_string(skin_vertices.rows()) +
                                " vertices, the skin has " + std::to_string(m_vertex_count),
                            "give the same skin in another pose");
    Points result(static_cast<Eigen::Index>(m_places.size()), 3);
    for (size_t i = 0; i < m_places.size(); ++i) {
        const Place& place = m_places[i];
        result.row(static_cast<Eigen::Index>(i)) =
            weighted_corners(skin_vertices, m_faces, place.face, place.weights) +
            face_frame(skin_vertices, m_faces, place.face) * place.offset;
    }
    return result;
}

}  // namespace cloth
