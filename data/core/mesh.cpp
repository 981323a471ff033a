#include "data/core/mesh.h"

#include <algorithm>
#include <map>

#include "data/core/errors.h"

namespace cloth {

Points face_area_vectors(const Points& vertices, const Faces& faces) {
    Points areas(faces.rows(), 3);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vec3 a = vertices.row(faces(f, 0));
        const Vec3 b = vertices.row(faces(f, 1));
        const Vec3 c = vertices.row(faces(f, 2));
        areas.row(f) = 0.5 * (b - a).cross(c - a);
    }
    return areas;
}

static void normalize_rows(Points& rows) {
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        const double length = rows.row(i).norm();
        if (length > 0.0) rows.row(i) /= length;
    }
}

Points face_normals(const Points& vertices, const Faces& faces) {
    Points normals = face_area_vectors(vertices, faces);
    normalize_rows(normals);
    return normals;
}

void vertex_normals(const Points& vertices, const Faces& faces, Points& normals) {
    normals.setZero(vertices.rows(), 3);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vec3 a = vertices.row(faces(f, 0));
        const Vec3 b = vertices.row(faces(f, 1));
        const Vec3 c = vertices.row(faces(f, 2));
        const Vec3 area = (b - a).cross(c - a);
        for (int corner = 0; corner < 3; ++corner)
            normals.row(faces(f, corner)) += area.transpose();
    }
    normalize_rows(normals);
}

Points vertex_normals(const Points& vertices, const Faces& faces) {
    Points normals;
    vertex_normals(vertices, faces, normals);
    return normals;
}

std::vector<std::array<int, 2>> undirected_edges(const Faces& faces) {
    std::vector<std::array<int, 2>> edges;
    edges.reserve(static_cast<size_t>(faces.rows()) * 3);
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int a = faces(f, corner);
            const int b = faces(f, (corner + 1) % 3);
            edges.push_back({std::min(a, b), std::max(a, b)});
        }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

static void validate_faces(const std::string& name, const TriMesh& mesh) {
    const Points areas = face_area_vectors(mesh.vertices, mesh.faces);
    for (Eigen::Index f = 0; f < areas.rows(); ++f)
        if (!(areas.row(f).norm() > 1e-14))
            throw ArgumentError(name, "face " + std::to_string(f) + " has no area",
                                "remove degenerate faces and weld duplicate vertices");
}

static void validate_manifold(const std::string& name, const Faces& faces) {
    std::map<std::array<int, 2>, int> uses;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int a = faces(f, corner);
            const int b = faces(f, (corner + 1) % 3);
            if (++uses[{std::min(a, b), std::max(a, b)}] > 2)
                throw ArgumentError(name,
                                    "edge " + std::to_string(a) + "-" + std::to_string(b) +
                                        " has more than two faces",
                                    "split the mesh there, or remove duplicate faces");
        }
}

void validate_mesh(const std::string& name, const TriMesh& mesh) {
    if (mesh.vertices.rows() == 0 || mesh.faces.rows() == 0)
        throw ArgumentError(name, "the mesh has no vertices or no faces",
                            "give a triangle mesh with at least one face");
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        if (!mesh.vertices.row(i).allFinite())
            throw ArgumentError(name, "vertex " + std::to_string(i) + " is not finite",
                                "export the mesh again without NaN or infinite coordinates");
    if (mesh.faces.minCoeff() < 0 || mesh.faces.maxCoeff() >= mesh.vertices.rows())
        throw ArgumentError(name, "a face refers to a vertex that does not exist",
                            "number vertices from 0 to |V| - 1");
    validate_faces(name, mesh);
    validate_manifold(name, mesh.faces);
}

}  // namespace cloth
