#include "data/files/gltf_check.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/files/gltf_numbers.h"

namespace cloth {
namespace {

using nlohmann::json;

const json& list_in(const json& object, const char* key) {
    static const json none = json::array();
    const auto found = object.is_object() ? object.find(key) : object.end();
    return object.is_object() && found != object.end() && found->is_array() ? *found : none;
}

std::string name_in(const json& list, size_t number) {
    const json name = list[number].is_object() ? list[number].value("name", json()) : json();
    return name.is_string() ? printable(name) : std::to_string(number);
}

class GltfParts {
 public:
    explicit GltfParts(const std::string& path)
        : m_path(path),
          m_file(path),
          m_nodes(list_in(m_file.root(), "nodes")),
          m_meshes(list_in(m_file.root(), "meshes")),
          m_accessors(list_in(m_file.root(), "accessors").size()) {}

    void check_faces();
    void check_skins();
    void check_animations();

 private:
    [[noreturn]] void fail(const std::string& place, const std::string& problem) const {
        throw LoadError(m_path, place, problem, "export the file again");
    }
    std::string place_of(size_t mesh, size_t primitive) const;
    void check_faces(const json& primitive, const std::string& place);
    void check_weights(const json& primitive, size_t joints, const std::string& place);
    void check_channel(const json& channel, const json& samplers, const std::string& place) const;

    /// @return whether an accessor is there, and stored as it can be read
    bool is_readable(const json& object, const char* key, const std::string& place) const {
        return object.is_object() && object.contains(key) &&
               m_file.is_plain(m_file.index(object, key, place), place);
    }

    const std::string& m_path;
    GltfNumbers m_file;
    const json &m_nodes, &m_meshes;
    size_t m_accessors;
};

/// The attributes; none where the primitive is compressed, or of another kind than triangles.
const json& attributes_of(const json& primitive) {
    static const json none = json::object();
    constexpr int triangles = 4;  // strips and fans come after them
    if (!primitive.is_object() || primitive.contains("extensions")) return none;
    const json mode = primitive.value("mode", json(triangles));
    const auto found = primitive.find("attributes");
    const bool is_read = mode.is_number_integer() && mode >= triangles &&
                         found != primitive.end() && found->is_object() &&
                         found->contains("POSITION");
    return is_read ? *found : none;
}

std::string GltfParts::place_of(size_t mesh, size_t primitive) const {
    return "mesh " + name_in(m_meshes, mesh) + ", primitive " + std::to_string(primitive);
}

void GltfParts::check_faces() {
    for (size_t m = 0; m < m_meshes.size(); ++m) {
        const json& primitives = list_in(m_meshes[m], "primitives");
        for (size_t p = 0; p < primitives.size(); ++p) check_faces(primitives[p], place_of(m, p));
    }
}

void GltfParts::check_faces(const json& primitive, const std::string& place) {
    const json& attributes = attributes_of(primitive);
    if (attributes.empty() || !is_readable(primitive, "indices", place)) return;
    const size_t vertices = m_file.count(m_file.index(attributes, "POSITION", place), place);
    const std::string faces = place + ", faces";
    for (const std::uint32_t corner :
         m_file.read_whole(m_file.index(primitive, "indices", place), 1, faces))
        if (corner >= vertices)
            fail(faces, "one refers to a vertex that does not exist, no. " +
                            std::to_string(corner) + " of " + std::to_string(vertices));
}

void GltfParts::check_skins() {
    const json& skins = list_in(m_file.root(), "skins");
    std::set<std::pair<size_t, size_t>> done;
    for (const json& node : m_nodes) {
        if (!node.is_object() || !node.contains("mesh") || !node.contains("skin")) continue;
        const size_t mesh = m_file.index(node, "mesh", "nodes");
        const size_t skin = m_file.index(node, "skin", "nodes");
        if (mesh >= m_meshes.size() || skin >= skins.size())
            fail("nodes", "one refers to a mesh or skin that is not there");
        if (!done.emplace(mesh, skin).second) continue;
        const json& primitives = list_in(m_meshes[mesh], "primitives");
        for (size_t p = 0; p < primitives.size(); ++p)
            check_weights(primitives[p], list_in(skins[skin], "joints").size(), place_of(mesh, p));
    }
}

void GltfParts::check_weights(const json& primitive, size_t joint_count, const std::string& place) {
    const json& attributes = attributes_of(primitive);
    for (int set = 0;; ++set) {
        const std::string of_joints = "JOINTS_" + std::to_string(set);
        const std::string of_weights = "WEIGHTS_" + std::to_string(set);
        if (!is_readable(attributes, of_joints.c_str(), place) ||
            !is_readable(attributes, of_weights.c_str(), place))
            return;
        const size_t numbers = 4 * m_file.count(m_file.index(attributes, "POSITION", place), place);
        const std::vector<std::uint32_t> joints = m_file.read_whole(
            m_file.index(attributes, of_joints.c_str(), place), 4, place + ", " + of_joints);
        const std::vector<float> weights = m_file.read(
            m_file.index(attributes, of_weights.c_str(), place), 4, place + ", " + of_weights);
        if (joints.size() != numbers || weights.size() != numbers)
            fail(place, "it has joints or weights for another number of vertices than it has");
        for (size_t k = 0; k < numbers; ++k) {
            const auto vertex = [&] { return place + ", vertex " + std::to_string(k / 4); };
            if (!std::isfinite(weights[k])) fail(vertex(), "its skin weight is not finite");
            if (weights[k] != 0.0f && joints[k] >= joint_count)
                fail(vertex(), "its skin weight is for joint no. " + std::to_string(joints[k]) +
                                   ", and the skin has " + std::to_string(joint_count));
        }
    }
}

void GltfParts::check_animations() {
    const json& animations = list_in(m_file.root(), "animations");
    for (size_t a = 0; a < animations.size(); ++a) {
        const json& channels = list_in(animations[a], "channels");
        for (size_t c = 0; c < channels.size(); ++c)
            check_channel(channels[c], list_in(animations[a], "samplers"),
                          "animation " + name_in(animations, a) + ", channel " + std::to_string(c));
    }
}

void GltfParts::check_channel(const json& channel, const json& samplers,
                              const std::string& place) const {
    const size_t sampler = m_file.index(channel, "sampler", place);
    if (sampler >= samplers.size()) fail(place, "it refers to a sampler that is not there");
    for (const char* key : {"input", "output"})
        if (m_file.index(samplers[sampler], key, place) >= m_accessors)
            fail(place, std::string("its ") + key + " is not there");
    const json target = channel.value("target", json());
    if (target.is_object() && target.contains("extensions"))
        return;  // may say otherwise what moves
    if (m_file.index(target, "node", place) >= m_nodes.size())
        fail(place, "it refers to a node that is not there");
}

}  // namespace

void check_gltf_parts(const std::string& path) {
    GltfParts parts(path);
    parts.check_faces();
    parts.check_skins();
    parts.check_animations();
}

}  // namespace cloth
