#include "data/files/mesh_io.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "data/core/errors.h"
#include "data/files/import_scene.h"
#include "data/files/vertex_order.h"
#include "data/files/vertex_paint.h"

namespace cloth {

namespace {

using Key = std::array<float, 3>;

/// One mesh of the scene as a node places it.
struct Placement {
    const aiMesh* mesh;
    aiMatrix4x4 transform;
};

void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent,
             const std::string& name, std::vector<Placement>& placements) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const aiMesh* mesh = scene.mMeshes[node.mMeshes[i]];
        if (name.empty() || name == mesh->mName.C_Str() || name == node.mName.C_Str())
            placements.push_back({mesh, transform});
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i)
        collect(scene, *node.mChildren[i], transform, name, placements);
}

std::string mesh_names(const aiScene& scene) {
    std::set<std::string> names;
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) names.insert(scene.mMeshes[i]->mName.C_Str());
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return list;
}

/// Before anything walks the faces: assimp's own steps trust the numbers in them.
void check_faces(const std::string& path, const aiMesh& mesh) {
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        const std::string place =
            std::string("mesh ") + mesh.mName.C_Str() + ", face " + std::to_string(f);
        if (face.mNumIndices < 3)
            throw LoadError(path, place, "it has " + std::to_string(face.mNumIndices) + " corners",
                            "the file may be truncated: export it again, without points and lines");
        for (unsigned c = 0; c < face.mNumIndices; ++c)
            if (face.mIndices[c] >= mesh.mNumVertices)
                throw LoadError(path, place, "it refers to a vertex that does not exist",
                                "export the mesh again");
    }
}

const aiScene& read_scene(const std::string& path, Assimp::Importer& importer) {
    const aiScene* scene = import_scene(importer, path, aiProcess_ValidateDataStructure);
    if (!scene)
        throw LoadError(path, "", std::string("cannot be read: ") + importer.GetErrorString(),
                        "give a whole OBJ, PLY, glTF or COLLADA file; export it again if this one "
                        "is damaged");
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) check_faces(path, *scene->mMeshes[i]);
    if (!importer.ApplyPostProcessing(aiProcess_Triangulate) || !scene->mRootNode)
        throw LoadError(path, "", "its polygons cannot be cut into triangles",
                        "export it again as triangles");
    return *scene;
}

/// Builds the welded mesh, one placed aiMesh after the other.
class MeshBuilder {
 public:
    MeshBuilder(std::string path, std::map<std::string, FilePositions> file_positions,
                FacesWithoutArea without_area, VertexPaint* paint)
        : m_path(std::move(path)),
          m_file_positions(std::move(file_positions)),
          m_without_area(without_area),
          m_paint(paint) {}

    /// Meshes of one geometry (assimp cuts it by material) share their vertices.
    void add(const std::vector<Placement>& parts) {
        const FilePositions& positions = positions_of(*parts.front().mesh);
        std::map<Key, FilePosition> used;
        int appearance = std::numeric_limits<int>::max() / 2;  // behind all that the file lists
        for (const Placement& part : parts)
            for (unsigned f = 0; f < part.mesh->mNumFaces; ++f) {
                const aiFace& face = part.mesh->mFaces[f];
                for (unsigned c = 0; c < 3; ++c)
                    use_corner(*part.mesh, face.mIndices[c], positions, used, appearance);
            }
        const std::map<Key, int> numbers = number_vertices(used, parts.front().transform);
        for (const Placement& part : parts) add_faces(part, numbers);
    }

    TriMesh finish() const {
        TriMesh mesh;
        mesh.vertices.resize(static_cast<Eigen::Index>(m_vertices.size()), 3);
        for (size_t i = 0; i < m_vertices.size(); ++i)
            mesh.vertices.row(static_cast<Eigen::Index>(i)) = m_vertices[i].transpose();
        mesh.faces.resize(static_cast<Eigen::Index>(m_faces.size()), 3);
        for (size_t f = 0; f < m_faces.size(); ++f)
            mesh.faces.row(static_cast<Eigen::Index>(f)) = m_faces[f].transpose();
        return mesh;
    }

 private:
    static Key key_of(const aiMesh& mesh, unsigned vertex) {
        const aiVector3D& p = mesh.mVertices[vertex];
        return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // -0 and 0 are one position
    }

    const FilePositions& positions_of(const aiMesh& mesh) const {
        static const FilePositions none;
        auto list = m_file_positions.find(mesh.mName.C_Str());
        if (list == m_file_positions.end()) list = m_file_positions.find("");
        return list == m_file_positions.end() ? none : list->second;
    }

    [[noreturn]] void refuse_position(const aiMesh& mesh, unsigned vertex, const Key& key) const {
        const std::string name = mesh.mName.C_Str();
        std::string place = place_of_bad_position(m_path, name, key);
        if (place.empty()) place = "mesh " + name + ", vertex " + std::to_string(vertex);
        throw LoadError(m_path, place, "its position is not finite",
                        "export the mesh again without NaN or infinite coordinates");
    }

    void use_corner(const aiMesh& mesh, unsigned vertex, const FilePositions& positions,
                    std::map<Key, FilePosition>& used, int& appearance) const {
        const Key key = key_of(mesh, vertex);
        if (!std::all_of(key.begin(), key.end(), [](float c) { return std::isfinite(c); }))
            refuse_position(mesh, vertex, key);
        const auto [entry, is_new] = used.try_emplace(key);
        if (!is_new) return;
        const auto listed = positions.find(key);
        if (listed != positions.end())
            entry->second = listed->second;
        else
            entry->second = {m_file_positions.empty() ? static_cast<int>(vertex) : appearance++,
                             Vec3(key[0], key[1], key[2])};
    }

    std::map<Key, int> number_vertices(const std::map<Key, FilePosition>& used,
                                       const aiMatrix4x4& t) {
        std::vector<std::pair<int, Key>> order;
        for (const auto& [key, position] : used) order.push_back({position.index, key});
        std::sort(order.begin(), order.end());
        Eigen::Matrix3d linear;
        linear << t.a1, t.a2, t.a3, t.b1, t.b2, t.b3, t.c1, t.c2, t.c3;
        const Vec3 offset(t.a4, t.b4, t.c4);
        std::map<Key, int> numbers;
        for (const auto& [index, key] : order) {
            numbers[key] = static_cast<int>(m_vertices.size());
            m_vertices.push_back(linear * used.at(key).value + offset);
        }
        return numbers;
    }

    void add_faces(const Placement& part, const std::map<Key, int>& numbers) {
        std::vector<int> vertices(part.mesh->mNumVertices, -1);
        for (unsigned f = 0; f < part.mesh->mNumFaces; ++f) {
            Eigen::Vector3i face;
            for (unsigned c = 0; c < 3; ++c) {
                const unsigned corner = part.mesh->mFaces[f].mIndices[c];
                face[c] = vertices[corner] = numbers.at(key_of(*part.mesh, corner));
            }
            const Vec3 a = m_vertices[static_cast<size_t>(face[0])];
            const Vec3 b = m_vertices[static_cast<size_t>(face[1])];
            const Vec3 c = m_vertices[static_cast<size_t>(face[2])];
            if (m_without_area == FacesWithoutArea::refuse &&
                !(0.5 * (b - a).cross(c - a).norm() > 1e-14))
                throw LoadError(m_path,
                                std::string("mesh ") + part.mesh->mName.C_Str() + ", triangle " +
                                    std::to_string(f),
                                "it has no area", "remove degenerate faces in a mesh editor");
            m_faces.push_back(face);
        }
        if (m_paint) m_paint->add(*part.mesh, vertices);
    }

    std::string m_path;
    std::map<std::string, FilePositions> m_file_positions;
    FacesWithoutArea m_without_area;
    VertexPaint* m_paint;
    std::vector<Vec3> m_vertices;
    std::vector<Eigen::Vector3i> m_faces;
};

bool same_geometry(const Placement& a, const Placement& b) {
    return a.mesh->mName == b.mesh->mName && a.transform == b.transform && a.mesh != b.mesh;
}

}  // namespace

std::vector<std::string> mesh_names(const std::string& path) {
    Assimp::Importer importer;
    const aiScene& scene = read_scene(path, importer);
    std::set<std::string> names;
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) names.insert(scene.mMeshes[i]->mName.C_Str());
    names.erase("");
    return {names.begin(), names.end()};
}

TriMesh load_mesh(const std::string& path, const std::string& mesh_name,
                  FacesWithoutArea without_area) {
    return load_mesh(path, mesh_name, without_area, nullptr);
}

TriMesh load_mesh(const std::string& path, const std::string& mesh_name,
                  FacesWithoutArea without_area, VertexPaint* paint) {
    Assimp::Importer importer;
    const aiScene& scene = read_scene(path, importer);
    std::vector<Placement> placements;
    collect(scene, *scene.mRootNode, aiMatrix4x4(), mesh_name, placements);
    if (placements.empty())
        throw LoadError(path, mesh_name.empty() ? "" : "mesh " + mesh_name, "there is no such mesh",
                        scene.mNumMeshes == 0
                            ? "give a file with at least one face"
                            : "give one of the names in the file: " + mesh_names(scene));
    if (paint) paint->open(path);
    MeshBuilder builder(path, read_file_positions(path), without_area, paint);
    for (size_t first = 0; first < placements.size();) {
        size_t last = first + 1;
        while (last < placements.size() && same_geometry(placements[first], placements[last]))
            ++last;
        builder.add({placements.begin() + static_cast<std::ptrdiff_t>(first),
                     placements.begin() + static_cast<std::ptrdiff_t>(last)});
        first = last;
    }
    return builder.finish();
}

void save_obj(const std::string& path, const TriMesh& mesh) {
    const std::string temporary = path + ".tmp";
    const LoadError failure(path, "", "cannot be written",
                            "check that the folder exists, may be written to and has space");
    std::FILE* file = std::fopen(temporary.c_str(), "wb");
    if (!file) throw failure;
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        std::fprintf(file, "v %.17g %.17g %.17g\n", mesh.vertices(i, 0), mesh.vertices(i, 1),
                     mesh.vertices(i, 2));
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        std::fprintf(file, "f %d %d %d\n", mesh.faces(f, 0) + 1, mesh.faces(f, 1) + 1,
                     mesh.faces(f, 2) + 1);
    bool written = std::ferror(file) == 0;
    written = std::fclose(file) == 0 && written;
    std::error_code error;
    if (written) std::filesystem::rename(temporary, path, error);
    if (!written || error) {
        std::filesystem::remove(temporary, error);
        throw failure;
    }
}

}  // namespace cloth
