#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "data/authoring/tshirt.h"
#include "data/authoring/tshirt_shape.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

using Json = nlohmann::json;

struct NumberField {
    const char* name;
    double TshirtRecipe::*member;
    double low, high;
};

constexpr NumberField kNumbers[] = {
    {"neck_tilt", &TshirtRecipe::neck_tilt, 0.0, 60.0},
    {"neck_half_width", &TshirtRecipe::neck_half_width, 0.05, 0.15},
    {"neck_half_depth", &TshirtRecipe::neck_half_depth, 0.05, 0.15},
    {"sleeve_length", &TshirtRecipe::sleeve_length, 0.3, 0.8},
    {"hem_height", &TshirtRecipe::hem_height, 0.3, 1.5},
    {"chest_ease", &TshirtRecipe::chest_ease, 0.008, 0.05},
    {"sleeve_ease", &TshirtRecipe::sleeve_ease, 0.008, 0.05},
    {"drape_radius", &TshirtRecipe::drape_radius, 0.3, 10.0},
    {"clearance", &TshirtRecipe::clearance, 0.001, 0.01},
};

constexpr double farthest = 5.0;  // coordinates (m)

struct PointField {
    const char* name;
    Vec3 TshirtRecipe::*member;
};

const PointField kPoints[] = {
    {"shoulder", &TshirtRecipe::shoulder},
    {"elbow", &TshirtRecipe::elbow},
    {"armpit", &TshirtRecipe::armpit},
    {"neck", &TshirtRecipe::neck},
};

double number_in(const std::string& path, const std::string& field, const Json& value, double low,
                 double high) {
    if (!value.is_number())
        throw LoadError(path, "field " + field, "it is not a number", "see data/tshirt.h");
    const double number = value.get<double>();
    if (!(number >= low && number <= high))
        throw LoadError(path, "field " + field, printable(value.dump()) + " is out of range",
                        "give " + Json(low).dump() + " to " + Json(high).dump());
    return number;
}

Vec3 point_in(const std::string& path, const std::string& field, const Json& value) {
    if (!value.is_array() || value.size() != 3)
        throw LoadError(path, "field " + field, "it is not a list of three numbers",
                        "give [x, y, z] in metres");
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis)
        point[axis] = number_in(path, field, value[static_cast<size_t>(axis)], -farthest, farthest);
    return point;
}

Json read_json(const std::string& path) {
    const std::string text = read_file(path);
    try {
        Json json = Json::parse(text);
        if (json.is_object()) return json;
    } catch (const Json::exception& error) {
        throw LoadError(path, "", error.what(), "repair the JSON, or restore the file");
    }
    throw LoadError(path, "", "it is not a JSON object", "see data/assets/garments/tshirt.json");
}

}  // namespace

TshirtRecipe load_tshirt_recipe(const std::string& path) {
    const Json json = read_json(path);
    TshirtRecipe recipe;
    std::set<std::string> known = {"about", "target_vertices"};
    if (json.contains("target_vertices"))
        recipe.target_vertices = static_cast<int>(
            number_in(path, "target_vertices", json["target_vertices"], 500, 20000));
    for (const NumberField& field : kNumbers) {
        known.insert(field.name);
        if (json.contains(field.name))
            recipe.*field.member =
                number_in(path, field.name, json[field.name], field.low, field.high);
    }
    for (const PointField& field : kPoints) {
        known.insert(field.name);
        if (json.contains(field.name))
            recipe.*field.member = point_in(path, field.name, json[field.name]);
    }
    for (const auto& [name, value] : json.items())
        if (!known.count(name))
            throw LoadError(path, "field " + printable(name), "there is no such field",
                            "see data/tshirt.h");
    return recipe;
}

void check_tshirt_recipe(const TshirtRecipe& recipe) {
    check_range("TshirtRecipe.target_vertices", recipe.target_vertices, 500, 20000);
    for (const NumberField& field : kNumbers)
        check_range(std::string("TshirtRecipe.") + field.name, recipe.*field.member, field.low,
                    field.high);
    for (const PointField& field : kPoints)
        for (int axis = 0; axis < 3; ++axis)
            check_range(std::string("TshirtRecipe.") + field.name, (recipe.*field.member)[axis],
                        -farthest, farthest);
}

}  // namespace cloth
