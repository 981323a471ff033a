#include "data/files/painted_places.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "data/files/ply_layout.h"
#include "data/files/vertex_order.h"

namespace cloth {

void PaintedVertex::tighten(const PaintedVertex& other) {
    for (size_t k = 0; k < 2; ++k) values[k] = std::min(values[k], other.values[k]);
    for (size_t k = 2; k < 4; ++k) values[k] = std::max(values[k], other.values[k]);
}

const std::array<std::string, 4>& goal_names() {
    static const std::array<std::string, 4> names{"max_distance", "backstop", "drive_stiffness",
                                                  "drive_damping"};
    return names;
}

int goal_named(std::string name) {
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto& names = goal_names();
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

void check_painted(const std::string& path, const std::string& place, int goal, double value) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double most[] = {infinity, infinity, 1e6, 1e4};
    if (value >= 0.0 && value <= most[goal]) return;
    const std::string range = goal == 0   ? "0 or more (m); what is free has infinity"
                              : goal == 1 ? "0 or more (m); what has none has infinity"
                              : goal == 2 ? "0 to 1e6 (1/s^2)"
                                          : "0 to 1e4 (1/s)";
    throw LoadError(
        path, place,
        std::isnan(value) ? "it is not a number" : std::to_string(value) + " is out of range",
        "paint " + goal_names()[static_cast<size_t>(goal)] + " as " + range);
}

std::vector<PaintedPart> read_painted_ply(const std::string& path) {
    const std::string text = read_file(path);
    const PlyLayout layout = read_ply_layout(path, text);
    PlyCursor cursor(text, layout);
    PaintedPart part;
    for (const PlyElement& element : layout.elements) {
        if (element.name != "vertex") {  // to be stepped over: it may come first
            for (long row = 0; row < element.count; ++row)
                for (const PlyProperty& property : element.properties) cursor.skip(property);
            continue;
        }
        std::vector<int> goals;
        for (const PlyProperty& property : element.properties) {
            const int goal = property.count_bytes > 0 ? -1 : goal_named(property.name);
            goals.push_back(goal);
            if (goal >= 0) part.has[static_cast<size_t>(goal)] = true;
        }
        if (!part.any()) return {};
        for (long row = 0; row < element.count; ++row) {
            PaintedVertex& vertex = part.rows.emplace_back();
            for (size_t k = 0; k < goals.size(); ++k) {
                const PlyProperty& property = element.properties[k];
                double value = 0.0;
                if (goals[k] < 0 ? !cursor.skip(property) : !cursor.read(property, value))
                    throw LoadError(path, "vertex " + std::to_string(row),
                                    "the file ends too early",
                                    "it is truncated: export or download it again");
                if (goals[k] < 0) continue;
                const auto goal = static_cast<size_t>(goals[k]);
                check_painted(path, "vertex " + std::to_string(row) + ", " + goal_names()[goal],
                              goals[k], value);
                vertex.values[goal] = value;
            }
        }
        return {part};
    }
    return {};
}

std::vector<PaintedPart> read_painted_parts(const std::string& path) {
    const std::string extension = extension_of(path);
    if (extension == "gltf" || extension == "glb") return read_painted_gltf(path);
    if (extension == "ply") return read_painted_ply(path);
    return {};
}

}  // namespace cloth
