#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/files/gltf_numbers.h"
#include "data/files/painted_places.h"

namespace cloth {

namespace {

using nlohmann::json;

/// The attributes of a primitive that are goals', by their number.
std::map<int, std::pair<std::string, size_t>> goals_of(const GltfNumbers& file,
                                                       const json& attributes,
                                                       const std::string& place) {
    std::map<int, std::pair<std::string, size_t>> found;
    if (!attributes.is_object()) return found;
    for (const auto& entry : attributes.items()) {
        const std::string& name = entry.key();
        const int goal = name.size() > 1 && name[0] == '_' ? goal_named(name.substr(1)) : -1;
        if (goal >= 0) found[goal] = {name, file.index(attributes, name.c_str(), place)};
    }
    return found;
}

PaintedPart read_primitive(const std::string& path, GltfNumbers& file, const json& attributes,
                           const std::string& place) {
    PaintedPart part;
    const auto goals = goals_of(file, attributes, place);
    if (goals.empty()) return part;
    const std::vector<float> positions =
        file.read(file.index(attributes, "POSITION", place), 3, place + ", POSITION");
    const size_t vertices = positions.size() / 3;
    std::vector<PaintedVertex> painted(vertices);
    for (const auto& [goal, attribute] : goals) {
        const auto& [name, accessor] = attribute;
        const std::vector<float> values = file.read(accessor, 1, place + ", " + name);
        if (values.size() != vertices)
            throw LoadError(path, place + ", " + name,
                            "it has " + std::to_string(values.size()) + " values for " +
                                std::to_string(vertices) + " vertices",
                            "store one number per vertex");
        for (size_t i = 0; i < vertices; ++i) {
            const auto value = static_cast<double>(values[i]);
            check_painted(path, place + ", " + name + ", vertex " + std::to_string(i), goal, value);
            painted[i].values[static_cast<size_t>(goal)] = value;
        }
        part.has[static_cast<size_t>(goal)] = true;
    }
    for (size_t i = 0; i < vertices; ++i) {
        // -0 and 0 are one position, as for load_mesh().
        const std::array<float, 3> key{positions[3 * i] + 0.0f, positions[3 * i + 1] + 0.0f,
                                       positions[3 * i + 2] + 0.0f};
        if (std::isnan(key[0]) || std::isnan(key[1]) || std::isnan(key[2])) continue;
        const auto [entry, is_new] = part.places.try_emplace(key, painted[i]);
        if (!is_new) entry->second.tighten(painted[i]);
    }
    return part;
}

}  // namespace

std::vector<PaintedPart> read_painted_gltf(const std::string& path) {
    GltfNumbers file(path);
    std::vector<PaintedPart> parts;
    const json meshes = file.root().value("meshes", json::array());
    for (size_t m = 0; meshes.is_array() && m < meshes.size(); ++m) {
        if (!meshes[m].is_object()) continue;
        const json primitives = meshes[m].value("primitives", json::array());
        for (size_t p = 0; primitives.is_array() && p < primitives.size(); ++p) {
            if (!primitives[p].is_object() || !primitives[p].contains("attributes")) continue;
            const json name = meshes[m].value("name", json());
            const std::string place =
                "mesh " + (name.is_string() ? printable(name) : std::to_string(m)) +
                (primitives.size() > 1 ? ", primitive " + std::to_string(p) : "");
            PaintedPart part = read_primitive(path, file, primitives[p]["attributes"], place);
            if (part.any()) parts.push_back(std::move(part));
        }
    }
    return parts;
}

}  // namespace cloth
