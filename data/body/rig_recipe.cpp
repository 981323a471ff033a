#include "data/body/rig_recipe.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"
#include "data/files/json_integers.h"

namespace cloth {

namespace {

using nlohmann::json;

constexpr const char* remedy = "restore data/assets/body_rig.json or correct the entry";

using Index = std::map<std::string, int>;

/// Reads the entries; the callers' names of places go into the errors.
class RecipeReader {
 public:
    explicit RecipeReader(const std::string& path) : m_path(path) {}

    [[noreturn]] void fail(const std::string& place, const std::string& problem) const {
        throw LoadError(m_path, printable(place), printable(problem), remedy);
    }

    int look_up(const Index& index, const json& name, const std::string& place) const {
        const auto found = index.find(name.get<std::string>());
        if (found == index.end()) fail(place, "unknown name '" + name.get<std::string>() + "'");
        return found->second;
    }

    RigPoint point(const std::string& name, const json& entry, int vertex_count) const {
        RigPoint point{name, {}, entry.at("weights").get<std::vector<double>>()};
        read_integer(entry.at("vertices"), "vertices", point.vertices);
        const double sum = std::accumulate(point.weights.begin(), point.weights.end(), 0.0);
        if (point.vertices.empty() || point.vertices.size() != point.weights.size())
            fail("point " + name, "needs one weight per vertex");
        if (!(std::abs(sum - 1.0) < 1e-6)) fail("point " + name, "its weights do not sum to 1");
        for (int vertex : point.vertices)
            if (vertex < 0 || vertex >= vertex_count)
                fail("point " + name, "vertex " + std::to_string(vertex) + " is out of range");
        return point;
    }

    RigRecipe recipe(const json& root) const {
        RigRecipe recipe;
        recipe.model = root.at("mesh").at("file");
        recipe.mesh_name = root.at("mesh").at("name");
        read_integer(root.at("mesh").at("vertices"), "mesh.vertices", recipe.vertex_count);
        Index points, joints;
        for (const auto& [name, entry] : root.at("points").items()) {
            points[name] = static_cast<int>(recipe.points.size());
            recipe.points.push_back(point(name, entry, recipe.vertex_count));
        }
        for (const json& entry : root.at("joints")) {
            const std::string name = entry.at("name");
            const std::string place = "joint " + name;
            const json& parent = entry.at("parent");
            if (parent.is_null() != recipe.joints.empty())
                fail(place, "the first joint, and only the first, has no parent");
            recipe.joints.push_back({name, parent.is_null() ? -1 : look_up(joints, parent, place),
                                     look_up(points, entry.at("point"), place)});
            joints[name] = static_cast<int>(recipe.joints.size()) - 1;
        }
        for (const json& entry : root.at("bones")) {
            const std::string place = "bone " + std::to_string(recipe.bones.size());
            recipe.bones.push_back({look_up(joints, entry.at("joint"), place),
                                    look_up(points, entry.at("from"), place),
                                    look_up(points, entry.at("to"), place)});
        }
        if (recipe.joints.empty() || recipe.bones.empty()) fail("", "holds no joints or no bones");
        return recipe;
    }

 private:
    std::string m_path;
};

}  // namespace

Vec3 RigPoint::position(const Points& skin) const {
    Vec3 sum = Vec3::Zero();
    for (size_t k = 0; k < vertices.size(); ++k)
        sum += weights[k] * skin.row(vertices[k]).transpose();
    return sum;
}

RigRecipe load_rig_recipe(const std::string& path) {
    const std::string text = read_file(path);
    try {
        return RecipeReader(path).recipe(json::parse(text));
    } catch (const json::exception& error) {
        throw LoadError(path, "", error.what(), remedy);
    } catch (const ArgumentError& error) {
        throw LoadError(path, "", error.what(), remedy);
    }
}

}  // namespace cloth
