#include "data/authoring/garment_recipe.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

using Json = nlohmann::json;

struct NumberField {
    const char* name;
    double GarmentRecipe::*member;
    double low, high;
};

constexpr NumberField kNumbers[] = {
    {"hem", &GarmentRecipe::hem, -0.5, 1.95},
    {"rise", &GarmentRecipe::rise, -0.1, 0.15},
    {"neck_tilt", &GarmentRecipe::neck_tilt, 0.0, 60.0},
    {"neck_half_width", &GarmentRecipe::neck_half_width, 0.05, 0.15},
    {"neck_half_depth", &GarmentRecipe::neck_half_depth, 0.05, 0.15},
    {"strap_width", &GarmentRecipe::strap_width, 0.02, 0.1},
    {"armhole_drop", &GarmentRecipe::armhole_drop, 0.0, 0.1},
    {"ease", &GarmentRecipe::ease, 0.006, 0.05},
    {"sleeve_ease", &GarmentRecipe::sleeve_ease, 0.006, 0.05},
    {"leg_ease", &GarmentRecipe::leg_ease, 0.006, 0.05},
    {"drape_radius", &GarmentRecipe::drape_radius, 0.3, 10.0},
    {"clearance", &GarmentRecipe::clearance, 0.001, 0.01},
    {"band_width", &GarmentRecipe::band_width, 0.02, 0.1},
    {"band_ratio", &GarmentRecipe::band_ratio, 0.5, 1.0},
};

struct OptionalField {
    const char* name;
    std::optional<double> GarmentRecipe::*member;
    double low, high;
};

constexpr OptionalField kOptional[] = {
    {"hem_height", &GarmentRecipe::hem_height, 0.02, 1.5},
    {"flare", &GarmentRecipe::flare, 0.0, 1.0},
};

constexpr int fewest_vertices = 500, most_vertices = 60000;
constexpr double shortest_sleeve = 0.3, longest_sleeve = 1.95;
constexpr double shortest_leg = 0.35, longest_leg = 1.95;
constexpr double farthest = 5.0;  // coordinates (m)

struct LandmarkField {
    const char* name;
    Vec3 BodyLandmarks::*member;
};

constexpr LandmarkField kLandmarks[] = {
    {"shoulder", &BodyLandmarks::shoulder}, {"elbow", &BodyLandmarks::elbow},
    {"wrist", &BodyLandmarks::wrist},       {"armpit", &BodyLandmarks::armpit},
    {"neck", &BodyLandmarks::neck},         {"waist", &BodyLandmarks::waist},
    {"hip", &BodyLandmarks::hip},           {"crotch", &BodyLandmarks::crotch},
    {"knee", &BodyLandmarks::knee},         {"ankle", &BodyLandmarks::ankle},
};

const char* const kSeeHeader = "see data/authoring/garment_recipe.h";

double number_in(const std::string& path, const std::string& field, const Json& value, double low,
                 double high) {
    if (!value.is_number())
        throw LoadError(path, "field " + field, "it is not a number", kSeeHeader);
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

/// One of two words.
template <typename Choice>
void choose(const std::string& path, const Json& json, const char* field, const char* first,
            const char* second, Choice& choice) {
    if (!json.contains(field)) return;
    const Json& value = json[field];
    if (value != first && value != second)
        throw LoadError(path, std::string("field ") + field,
                        printable(value.dump()) + " is not one of its words",
                        std::string("give ") + first + " or " + second);
    choice = value == first ? static_cast<Choice>(0) : static_cast<Choice>(1);
}

void read_numbers(const std::string& path, const Json& json, std::set<std::string>& known,
                  GarmentRecipe& recipe) {
    for (const NumberField& field : kNumbers) {
        known.insert(field.name);
        if (json.contains(field.name))
            recipe.*field.member =
                number_in(path, field.name, json[field.name], field.low, field.high);
    }
    for (const OptionalField& field : kOptional) {
        known.insert(field.name);
        if (json.contains(field.name))
            recipe.*field.member =
                number_in(path, field.name, json[field.name], field.low, field.high);
    }
    for (const LandmarkField& field : kLandmarks) {
        known.insert(field.name);
        if (json.contains(field.name))
            recipe.landmarks[field.name] = point_in(path, field.name, json[field.name]);
    }
}

}  // namespace

GarmentRecipe load_garment_recipe(const std::string& path) {
    const Json json = read_json(path);
    GarmentRecipe recipe;
    std::set<std::string> known = {"about", "target_vertices", "from", "to", "sleeve_length"};
    if (json.contains("target_vertices"))
        recipe.target_vertices = static_cast<int>(number_in(
            path, "target_vertices", json["target_vertices"], fewest_vertices, most_vertices));
    choose(path, json, "from", "shoulders", "waist", recipe.from);
    choose(path, json, "to", "hem", "legs", recipe.to);
    if (json.contains("sleeve_length")) {
        const bool none = json["sleeve_length"] == 0;
        recipe.sleeve_length = number_in(path, "sleeve_length", json["sleeve_length"],
                                         none ? 0.0 : shortest_sleeve, longest_sleeve);
    }
    read_numbers(path, json, known, recipe);
    if (recipe.to == GarmentRecipe::To::legs && !recipe.hem_height)
        number_in(path, "hem", recipe.hem, shortest_leg, longest_leg);
    for (const auto& [name, value] : json.items())
        if (!known.count(name))
            throw LoadError(path, "field " + printable(name), "there is no such field", kSeeHeader);
    return recipe;
}

void GarmentRecipe::check() const {
    const std::string prefix = "GarmentRecipe.";
    check_range(prefix + "target_vertices", target_vertices, fewest_vertices, most_vertices);
    if (sleeve_length != 0.0)
        check_range(prefix + "sleeve_length", sleeve_length, shortest_sleeve, longest_sleeve);
    for (const NumberField& field : kNumbers)
        check_range(prefix + field.name, this->*field.member, field.low, field.high);
    for (const OptionalField& field : kOptional)
        if (const auto& value = this->*field.member)
            check_range(prefix + field.name, *value, field.low, field.high);
    if (to == To::legs && !hem_height) check_range(prefix + "hem", hem, shortest_leg, longest_leg);
    for (const auto& [name, point] : landmarks) {
        const auto is_called = [&name = name](const LandmarkField& f) { return name == f.name; };
        if (std::none_of(std::begin(kLandmarks), std::end(kLandmarks), is_called))
            throw ArgumentError(prefix + "landmarks: " + name, "there is no such landmark",
                                kSeeHeader);
        for (int axis = 0; axis < 3; ++axis)
            check_range(prefix + name, point[axis], -farthest, farthest);
    }
}

BodyLandmarks GarmentRecipe::landmarks_on(const BodyLandmarks& body) const {
    BodyLandmarks marks = body;
    for (const LandmarkField& field : kLandmarks)
        if (const auto own = landmarks.find(field.name); own != landmarks.end())
            marks.*field.member = own->second;
    return marks;
}

}  // namespace cloth
