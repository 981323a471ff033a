#include "data/body/character_rig.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <utility>

#include "data/core/errors.h"
#include "data/files/import_scene.h"

namespace cloth {

namespace {

constexpr int max_influences = 8;

Eigen::Affine3d to_eigen(const aiMatrix4x4& m) {
    Eigen::Affine3d result = Eigen::Affine3d::Identity();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            result.matrix()(row, column) = m[static_cast<unsigned>(row)][column];
    return result;
}

Vec3 to_eigen(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

Eigen::Quaterniond to_eigen(const aiQuaternion& q) {
    return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
}

/// Fills a rig from assimp's scene.
class CharacterReader {
 public:
    explicit CharacterReader(std::string path) : m_path(std::move(path)) {}

    CharacterRig read(const std::string& animation, const std::string& mesh_name) {
        Assimp::Importer importer;
        const aiScene& scene = open(importer);
        add_nodes(*scene.mRootNode, -1);
        if (const aiAnimation* found = find_animation(scene, animation)) add_animation(*found);
        add_meshes(*scene.mRootNode, scene, mesh_name);
        if (m_faces.empty())
            fail("mesh " + mesh_name, "there is no such mesh with triangles",
                 "give one of" + mesh_names(scene) + ", or no name for all of them");
        finish();
        return std::move(m_rig);
    }

 private:
    [[noreturn]] void fail(const std::string& place, const std::string& problem,
                           const std::string& remedy) const {
        throw LoadError(m_path, place, problem, remedy);
    }

    const aiScene& open(Assimp::Importer& importer) const {
        const aiScene* scene = import_scene(importer, m_path, aiProcess_Triangulate);
        if (!scene || !scene->mRootNode)
            fail("", std::string("cannot be read: ") + importer.GetErrorString(),
                 "export it again; it may be damaged");
        return *scene;
    }

    void add_nodes(const aiNode& node, int parent) {
        const int index = static_cast<int>(m_rig.nodes.size());
        if (!to_eigen(node.mTransformation).matrix().allFinite())
            fail(std::string("node ") + node.mName.C_Str(), "its transform is not finite",
                 "export it again");
        m_nodes.try_emplace(node.mName.C_Str(), index);
        m_rig.nodes.push_back({parent, to_eigen(node.mTransformation), std::nullopt});
        for (unsigned i = 0; i < node.mNumChildren; ++i) add_nodes(*node.mChildren[i], index);
    }

    int node_index(const std::string& name, const std::string& place) const {
        const auto found = m_nodes.find(name);
        if (found == m_nodes.end())
            fail(place, "refers to the unknown joint '" + name + "'",
                 "export it again with its skeleton");
        return found->second;
    }

    /// @return  null: none is asked for, and there is none
    const aiAnimation* find_animation(const aiScene& scene, const std::string& name) const {
        std::string names;
        for (unsigned i = 0; i < scene.mNumAnimations; ++i) {
            const std::string other = scene.mAnimations[i]->mName.C_Str();
            if (name.empty() || other == name) return scene.mAnimations[i];
            names += " '" + other + "'";
        }
        if (name.empty()) return nullptr;
        fail("animation " + name, "there is no such animation",
             names.empty() ? "leave the name out: the file has no animation, and stands still"
                           : "give one of" + names);
    }

    void add_animation(const aiAnimation& animation) {
        m_rig.unread_morphs = animation.mNumMorphMeshChannels > 0;
        if (animation.mNumChannels == 0) return;  // it has a duration, and moves nothing
        // Files may leave the unit out; assimp's documentation names 25 as the convention then.
        const double ticks = animation.mTicksPerSecond > 0.0 ? animation.mTicksPerSecond : 25.0;
        for (unsigned c = 0; c < animation.mNumChannels; ++c) {
            const aiNodeAnim& channel = *animation.mChannels[c];
            const std::string place = std::string("channel ") + channel.mNodeName.C_Str();
            const int node = node_index(channel.mNodeName.C_Str(), place);
            m_rig.nodes[node].track = static_cast<int>(m_rig.tracks.size());
            m_rig.tracks.push_back(read_track(channel, ticks, place));
        }
        double end = animation.mDuration / ticks;
        for (const CharacterTrack& track : m_rig.tracks)
            for (const auto* times :
                 {&track.position_times, &track.rotation_times, &track.scale_times})
                end = std::max(end, times->back());
        if (!std::isfinite(end)) fail("animation", "its duration is not finite", "export it again");
        m_rig.duration = end;
    }

    CharacterTrack read_track(const aiNodeAnim& channel, double ticks,
                              const std::string& place) const {
        CharacterTrack track;
        read_keys(channel.mPositionKeys, channel.mNumPositionKeys, ticks, place,
                  track.position_times, track.positions);
        read_keys(channel.mRotationKeys, channel.mNumRotationKeys, ticks, place,
                  track.rotation_times, track.rotations);
        read_keys(channel.mScalingKeys, channel.mNumScalingKeys, ticks, place, track.scale_times,
                  track.scales);
        return track;
    }

    static bool is_finite(const Vec3& value) { return value.allFinite(); }
    static bool is_finite(const Eigen::Quaterniond& value) { return value.coeffs().allFinite(); }

    template <typename Key, typename Value>
    void read_keys(const Key* keys, unsigned count, double ticks, const std::string& place,
                   std::vector<double>& times, std::vector<Value>& values) const {
        if (count == 0) fail(place, "has no keys", "export the animation with baked keys");
        for (unsigned k = 0; k < count; ++k) {
            times.push_back(keys[k].mTime / ticks);
            values.push_back(to_eigen(keys[k].mValue));
            if (!std::isfinite(times.back()) || !is_finite(values.back()))
                fail(place, "key " + std::to_string(k) + " is not finite", "export it again");
            if (k > 0 && times[k] < times[k - 1])
                fail(place, "its keys are not in order of time", "export it again");
        }
    }

    void add_meshes(const aiNode& node, const aiScene& scene, const std::string& name) {
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
            if (name.empty() || name == mesh.mName.C_Str() || name == node.mName.C_Str())
                add_mesh(mesh, m_nodes.at(node.mName.C_Str()));
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i)
            add_meshes(*node.mChildren[i], scene, name);
    }

    static std::string mesh_names(const aiScene& scene) {
        std::string names;
        for (unsigned m = 0; m < scene.mNumMeshes; ++m)
            names += std::string(" '") + scene.mMeshes[m]->mName.C_Str() + "'";
        return names.empty() ? " those of another file: this one has none" : names;
    }

    void add_mesh(const aiMesh& mesh, int node) {
        const std::string place = std::string("mesh ") + mesh.mName.C_Str();
        const std::vector<int> numbers = add_vertices(mesh, place);
        for (unsigned b = 0; b < mesh.mNumBones; ++b) add_bone(*mesh.mBones[b], numbers, place);
        add_unbound(mesh, node, numbers);
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices != 3) continue;  // loose points and edges of the file
            Eigen::Vector3i corners;
            for (unsigned c = 0; c < 3; ++c) {
                if (face.mIndices[c] >= mesh.mNumVertices)
                    fail(place + ", face " + std::to_string(f),
                         "refers to a vertex that does not exist", "export the mesh again");
                corners[c] = numbers[face.mIndices[c]];
            }
            const bool collapsed =
                corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
            if (!collapsed) m_faces.push_back(corners);
        }
    }

    /// Welds vertices at exactly the same position (files split them along texture seams); returns
    /// the number of each of the mesh's vertices.
    std::vector<int> add_vertices(const aiMesh& mesh, const std::string& place) {
        std::map<std::array<float, 3>, int> known;
        std::vector<int> numbers;
        for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
            const aiVector3D& p = mesh.mVertices[i];
            if (!to_eigen(p).allFinite())
                fail(place + ", vertex " + std::to_string(i), "its position is not finite",
                     "export the mesh again");
            const auto [entry, is_new] =
                known.try_emplace({p.x, p.y, p.z}, static_cast<int>(m_vertices.size()));
            if (is_new) {
                m_vertices.push_back(to_eigen(p));
                m_influences.emplace_back();
            }
            numbers.push_back(entry->second);
        }
        return numbers;
    }

    int add_joint(const std::string& name, int node, const Eigen::Affine3d& offset) {
        m_rig.joints.push_back({name, node, offset});
        return static_cast<int>(m_rig.joints.size()) - 1;
    }

    void add_bone(const aiBone& bone, const std::vector<int>& numbers, const std::string& place) {
        const std::string name = bone.mName.C_Str();
        const Eigen::Affine3d offset = to_eigen(bone.mOffsetMatrix);
        if (!offset.matrix().allFinite())
            fail(place + ", bone " + name, "its matrix is not finite", "export it again");
        const int joint = add_joint(name, node_index(name, place + ", bone " + name), offset);
        for (unsigned k = 0; k < bone.mNumWeights; ++k) {
            const aiVertexWeight& weight = bone.mWeights[k];
            if (weight.mVertexId >= numbers.size() || !std::isfinite(weight.mWeight))
                fail(place + ", bone " + name, "a weight is not finite or of no vertex",
                     "export it again");
            if (weight.mWeight > 0.0f)
                m_influences[numbers[weight.mVertexId]][joint] =
                    static_cast<double>(weight.mWeight);
        }
    }

    /// Vertices without bones follow the node that holds the mesh.
    void add_unbound(const aiMesh& mesh, int node, const std::vector<int>& numbers) {
        int joint = -1;
        for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
            std::map<int, double>& influences = m_influences[numbers[i]];
            if (!influences.empty()) continue;
            if (joint < 0) joint = add_joint(mesh.mName.C_Str(), node, Eigen::Affine3d::Identity());
            influences[joint] = 1.0;
        }
    }

    void finish() {
        m_rig.rest.resize(static_cast<Eigen::Index>(m_vertices.size()), 3);
        for (size_t i = 0; i < m_vertices.size(); ++i)
            m_rig.rest.row(static_cast<Eigen::Index>(i)) = m_vertices[i];
        Faces faces(static_cast<Eigen::Index>(m_faces.size()), 3);
        for (size_t f = 0; f < m_faces.size(); ++f)
            faces.row(static_cast<Eigen::Index>(f)) = m_faces[f];
        m_rig.faces = std::move(faces);
        Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(
            m_rig.rest.rows(), static_cast<Eigen::Index>(m_rig.joints.size()));
        for (size_t i = 0; i < m_influences.size(); ++i)
            for (const auto& [joint, weight] : m_influences[i])
                dense(static_cast<Eigen::Index>(i), joint) = weight;
        m_rig.weights = sparse_weights(dense, max_influences, 0.0);
    }

    std::string m_path;
    CharacterRig m_rig;
    std::map<std::string, int> m_nodes;
    std::vector<Vec3> m_vertices;
    std::vector<std::map<int, double>> m_influences;  ///< per vertex: joint -> weight
    std::vector<Eigen::Vector3i> m_faces;
};

}  // namespace

CharacterRig load_character_rig(const std::string& path, const std::string& animation,
                                const std::string& mesh_name) {
    return CharacterReader(path).read(animation, mesh_name);
}

}  // namespace cloth
