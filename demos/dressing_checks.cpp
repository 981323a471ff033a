#include "demos/dressing_checks.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "data/body/garment_fit.h"
#include "data/core/errors.h"
#include "data/core/length_units.h"
#include "data/core/mesh_pieces.h"
#include "data/core/surface_distance.h"

namespace cloth {

void check_height(const std::string& file, const WeldedCharacter& skin) {
    if (skin.height() >= 0.1 && skin.height() <= 10.0) return;
    std::string factors;
    char text[96];
    for (const LengthUnit& unit : plausible_units(skin.height(), 1.0, 2.5)) {
        std::snprintf(text, sizeof text, "%.4g if the file is in %s, ", unit.metres, unit.plural);
        factors += text;
    }
    std::snprintf(text, sizeof text, "%.3g makes it 1.7 m high", 1.7 / skin.height());
    const std::string remedy =
        "give --character-scale, the metres per unit of the file. Times " + factors + text;
    throw ArgumentError(file, "it is " + std::to_string(skin.height()) + " m high", remedy);
}

void check_surface(const std::string& file, const WeldedCharacter& skin) {
    validate_skin(file, skin.rest());
}

std::vector<std::string> character_notes(const std::string& file, const WeldedCharacter& skin) {
    if (!skin.has_unread_morphs()) return {};
    return {file +
            ": its animation changes morph targets (shape keys), which are not read; only its "
            "joints and nodes move it"};
}

void check_not_overwritten(const std::string& option, const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs, const std::string& remedy) {
    for (const std::string& input : inputs)
        for (const std::string& output : outputs) {
            std::error_code none;
            if (std::filesystem::equivalent(output, input, none))
                throw ArgumentError(option, input + " would be overwritten", remedy);
        }
}

std::vector<int> vertices_between(const Points& x, const std::vector<double>& heights) {
    std::vector<int> found;
    for (int i = 0; i < x.rows() && !heights.empty(); ++i)
        if (x(i, 1) >= heights[0] && x(i, 1) <= heights[1]) found.push_back(i);
    if (found.empty() && !heights.empty())
        throw ArgumentError("--pin",
                            "the garment, from " + std::to_string(x.col(1).minCoeff()) + " to " +
                                std::to_string(x.col(1).maxCoeff()) + " m, has no vertex there",
                            "give the lowest and highest height in metres, after scaling");
    return found;
}

double distance_to_skin(const Garment& garment, const WeldedCharacter& skin) {
    const double away = smallest_clearance(garment.rest(), SurfaceDistance(skin.rest()));
    if (away > 0.3)
        throw ArgumentError(garment.name(), "it is " + std::to_string(away) + " m from the skin",
                            "check --garment-scale, and that garment and character have the same "
                            "origin and axes");
    return away;
}

WornState worn_state(const Garment& garment, const Points& x, const TriMesh& skin) {
    WornState state;
    state.away = smallest_clearance({x, garment.rest().faces}, SurfaceDistance(skin));
    const Points& rest = garment.rest().vertices;
    std::vector<double> ratios;
    for (const auto& [a, b] : garment.edges())
        ratios.push_back((x.row(a) - x.row(b)).norm() / (rest.row(a) - rest.row(b)).norm());
    std::sort(ratios.begin(), ratios.end());
    state.stretch99 = ratios[ratios.size() * 99 / 100];
    state.stretch = ratios.back();
    return state;
}

std::string worn_problem(const WornState& state, long failed_steps) {
    const bool lost = failed_steps > 0 || state.away > 0.05 || state.stretch99 > 2.0;
    return lost ? "the garment is lost: it failed, fell off or was torn" : "";
}

}  // namespace cloth
