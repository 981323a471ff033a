#include "data/core/mesh_embedding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/surface_distance.h"
#include "data/core/triangle.h"

namespace cloth {

namespace {

constexpr double kCurved = 0.5;  // exact for surfaces of second order with exact normals

/// A face with the normals at its corners.
struct CurvedFace {
    std::array<Vec3, 3> corner, normal;

    CurvedFace(const Points& x, const Points& normals, const Faces& faces, int face) {
        for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<size_t>(c);
            corner[k] = x.row(faces(face, c));
            normal[k] = normals.row(faces(face, c));
        }
    }
    Vec3 flat(const Vec3& w) const {
        return w[0] * corner[0] + w[1] * corner[1] + w[2] * corner[2];
    }
    Vec3 curved(const Vec3& w) const {
        const Vec3 p = flat(w);
        Vec3 shift = Vec3::Zero();
        for (size_t c = 0; c < 3; ++c)
            shift -= w[static_cast<Eigen::Index>(c)] * (p - corner[c]).dot(normal[c]) * normal[c];
        return p + kCurved * shift;
    }
    Vec3 normal_at(const Vec3& w) const {
        return (w[0] * normal[0] + w[1] * normal[1] + w[2] * normal[2]).normalized();
    }
    /// Two edges, and the interpolated normal.
    Eigen::Matrix3d frame(const Vec3& w) const {
        Eigen::Matrix3d axes;
        axes << corner[1] - corner[0], corner[2] - corner[0], normal_at(w);
        return axes;
    }
};

/// The nearest of the faces that look the same way as `normal`; without one within the reach, the
/// nearest of all.
NearestPoint nearest_alike(const SurfaceDistance& surface, const Points& face_normals,
                           const Vec3& p, const Vec3& normal, double reach) {
    NearestPoint nearest = surface.nearest(p);
    if (face_normals.row(nearest.face).dot(normal) > 0.0) return nearest;
    const auto& [x, faces] = surface.surface();
    double best = reach * reach;
    for (int f = 0; f < faces.rows(); ++f) {
        if (!(face_normals.row(f).dot(normal) > 0.0)) continue;
        const TriangleHit hit =
            closest_on_triangle(p, x.row(faces(f, 0)), x.row(faces(f, 1)), x.row(faces(f, 2)));
        if (!(hit.squared < best)) continue;
        best = hit.squared;
        nearest.face = f;
        nearest.weights = hit.barycentric;
        nearest.distance = std::sqrt(hit.squared);
    }
    return nearest;
}

}  // namespace

MeshEmbedding::MeshEmbedding(const TriMesh& coarse, const TriMesh& fine,
                             const MeshEmbeddingSettings& settings)
    : m_faces(coarse.faces), m_coarse_size(coarse.vertices.rows()) {
    check_range("MeshEmbeddingSettings.reach", settings.reach, 1e-3, 1.0);
    validate_mesh("MeshEmbedding: coarse mesh", coarse);
    validate_mesh("MeshEmbedding: fine mesh", fine);
    const SurfaceDistance surface(coarse);
    const Points across = face_normals(coarse.vertices, coarse.faces);
    const Points normals = vertex_normals(coarse.vertices, coarse.faces);
    const Points fine_normals = vertex_normals(fine.vertices, fine.faces);
    m_places.reserve(static_cast<size_t>(fine.vertices.rows()));
    for (Eigen::Index i = 0; i < fine.vertices.rows(); ++i) {
        const Vec3 p = fine.vertices.row(i);
        const NearestPoint near =
            nearest_alike(surface, across, p, fine_normals.row(i), settings.reach);
        const double distance = std::abs(near.distance);
        if (distance > settings.reach)
            throw ArgumentError("MeshEmbedding: fine vertex " + std::to_string(i),
                                "it is " + std::to_string(distance) + " m from the coarse mesh",
                                "give both meshes in one place, pose and unit, or a longer reach");
        m_farthest = std::max(m_farthest, distance);
        const CurvedFace face(coarse.vertices, normals, coarse.faces, near.face);
        const Vec3 offset = p - face.curved(near.weights);
        Vec3 along = face.frame(near.weights).fullPivLu().solve(offset);
        if (!along.allFinite()) along = {0.0, 0.0, face.normal_at(near.weights).dot(offset)};
        m_places.push_back({near.face, near.weights, along});
    }
}

void MeshEmbedding::check_size(const Points& values) const {
    if (values.rows() != m_coarse_size)
        throw ArgumentError("MeshEmbedding",
                            "there are " + std::to_string(values.rows()) +
                                " vertices, the coarse mesh has " + std::to_string(m_coarse_size),
                            "give the same mesh in another pose");
}

void MeshEmbedding::positions(const Points& coarse, Points& fine) const {
    check_size(coarse);
    const Points normals = vertex_normals(coarse, m_faces);
    fine.resize(size(), 3);
    for (Eigen::Index i = 0; i < size(); ++i) {
        const Place& place = m_places[static_cast<size_t>(i)];
        const CurvedFace face(coarse, normals, m_faces, place.face);
        const Vec3 p = face.curved(place.weights);
        const Vec3 moved = p + face.frame(place.weights) * place.offset;
        fine.row(i) = moved.allFinite() ? moved : p;
    }
}

void MeshEmbedding::interpolate(const Points& values, Points& result) const {
    check_size(values);
    result.resize(size(), 3);
    for (Eigen::Index i = 0; i < size(); ++i) {
        const Place& place = m_places[static_cast<size_t>(i)];
        result.row(i).setZero();
        for (int c = 0; c < 3; ++c)
            result.row(i) += place.weights[c] * values.row(m_faces(place.face, c));
    }
}

std::array<int, 3> MeshEmbedding::corners(Eigen::Index fine) const {
    const int face = m_places[static_cast<size_t>(fine)].face;
    return {m_faces(face, 0), m_faces(face, 1), m_faces(face, 2)};
}

}  // namespace cloth
