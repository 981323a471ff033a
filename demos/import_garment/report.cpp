#include "demos/import_garment/report.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "demos/compare/json_numbers.h"
#include "demos/compare/shell_word.h"

namespace cloth {
namespace {

template <typename... Values>
std::string line(const char* format, Values... values) {
    char text[1200];
    std::snprintf(text, sizeof text, format, values...);
    return std::string(text) + "\n";
}

nlohmann::ordered_json pins_json(const GarmentSupport& support) {
    return {{"low_m", rounded_number(support.pin_low)},
            {"high_m", rounded_number(support.pin_high)}};
}

/// Nothing without a waistband.
nlohmann::ordered_json band_number(const GarmentSupport& support, double value) {
    if (support.kind != GarmentSupport::Kind::waistband) return {};
    return rounded_number(value);
}

nlohmann::ordered_json garment_json(const ImportedGarment& garment, const WrittenGarment& written) {
    const GarmentSupport& support = garment.support;
    nlohmann::ordered_json row = {
        {"file", written.file},
        {"worn_file", written.worn_file.empty() ? nlohmann::ordered_json()
                                                : nlohmann::ordered_json(written.worn_file)},
        {"sort", support.sort},
        {"held_by", name_of(support.kind)},
        {"vertices", garment.worn.vertices.rows()},
        {"vertices_before_remeshing", garment.vertices_before},
        {"faces", garment.worn.faces.rows()},
        {"mean_edge_mm", rounded_number(1e3 * garment.edge_length)},
        {"smallest_angle_before_deg", rounded_number(garment.angle_before)},
        {"smallest_angle_deg", rounded_number(garment.angle)},
        {"part_inside_before", rounded_number(garment.inside_before)},
        {"deepest_before_mm", rounded_number(1e3 * garment.deepest_before)},
        {"part_inside", rounded_number(garment.inside)},
        {"clearance_mm", rounded_number(1e3 * garment.clearance)},
        {"strain_1_percent", rounded_number(garment.strain_low)},
        {"strain_99_percent", rounded_number(garment.strain_high)},
        {"waistband_strain", rounded_number(garment.rest_strain)},
        {"pins", nullptr},
        {"waistband_vertices", support.upper_edge}};
    if (support.can_be_pinned()) row["pins"] = pins_json(support);
    for (const GarmentSupport& piece : garment.piece_support)
        row["pieces"].push_back(
            {{"sort", piece.sort},
             {"held_by", name_of(piece.kind)},
             {"waistband_worn_m", band_number(piece, piece.edge_length)},
             {"waist_girth_m", band_number(piece, piece.waist_girth)},
             {"pins", piece.can_be_pinned() ? pins_json(piece) : nlohmann::ordered_json()}});
    return row;
}

std::string holding_text(const GarmentSupport& support) {
    if (support.kind == GarmentSupport::Kind::shoulders) return "it hangs from the shoulders";
    char pins[64];
    std::snprintf(pins, sizeof pins, "--pin %.3f %.3f", support.pin_low, support.pin_high);
    if (support.kind == GarmentSupport::Kind::waistband)
        return "a waistband along its upper edge" +
               (support.can_be_pinned() ? "; or, on a --character, " + std::string(pins) : "");
    return support.can_be_pinned() ? "nothing: pin it by " + std::string(pins)
                                   : "nothing: paint goals on it, see data/README.md";
}

/// A piece that hangs from the shoulders does not hold another one.
std::string holding_lines(const ImportedGarment& garment) {
    if (garment.piece_support.size() == 1)
        return line("  held by      %s", holding_text(garment.support).c_str());
    std::string text;
    for (const GarmentSupport& piece : garment.piece_support)
        text += line("  held by      %s: %s", piece.sort.c_str(),
                     piece.kind == GarmentSupport::Kind::waistband
                         ? "a waistband along its upper edge"  // pins would fix the others, too
                         : holding_text(piece).c_str());
    return text;
}

/// What a waistband changes.
std::string band_lines(const ImportedGarment& garment) {
    std::string text;
    for (const GarmentSupport& piece : garment.piece_support)
        if (piece.kind == GarmentSupport::Kind::waistband)
            text += line(
                "  waistband    %.2f m round as worn, up to %.0f %% shorter at rest; the waist "
                "is %.2f m round",
                piece.edge_length, -1e2 * garment.rest_strain, piece.waist_girth);
    return text;
}

std::string garment_text(const ImportedGarment& garment, const WrittenGarment& written) {
    return line("%s", written.file.c_str()) +
           line("  is           %s", garment.support.sort.c_str()) + holding_lines(garment) +
           band_lines(garment) +
           line("  vertices     %d, before %d; mean edge %.1f mm",
                static_cast<int>(garment.worn.vertices.rows()), garment.vertices_before,
                1e3 * garment.edge_length) +
           line("  angles       smallest %.1f degrees, before %.1f", garment.angle,
                garment.angle_before) +
           line("  inside       %.1f %% of the vertices, before %.1f %%, up to %.1f mm deep",
                1e2 * garment.inside, 1e2 * garment.inside_before, 1e3 * garment.deepest_before) +
           line("  clearance    %.2f mm; being led out changed lengths by %+.1f to %+.1f %%",
                1e3 * garment.clearance, 1e2 * garment.strain_low, 1e2 * garment.strain_high);
}

/// The garments' numbers from the outermost inwards, where they overlap.
std::vector<size_t> outermost_first(const GarmentImport& import, const TriMesh& skin) {
    const SurfaceDistance distance(skin);
    std::vector<size_t> order(import.garments.size());
    std::iota(order.begin(), order.end(), size_t{0});
    // Few garments: each goes before the first one that it lies over.
    for (size_t k = 1; k < order.size(); ++k)
        for (size_t i = k; i > 0; --i) {
            const auto& upper = import.garments[order[i]].worn;
            const auto& lower = import.garments[order[i - 1]].worn;
            if (height_over(upper, lower, distance) <= 0.0) break;
            std::swap(order[i], order[i - 1]);
        }
    return order;
}

std::string joined(const std::vector<std::string>& lines, const std::string& head) {
    std::string all;
    for (const std::string& text : lines) all += head + text + "\n";
    return all;
}

std::string outfit_name(const GarmentImport& import, const std::vector<WrittenGarment>& written,
                        const TriMesh& skin) {
    std::string outfit;
    for (const size_t k : outermost_first(import, skin))
        outfit += (outfit.empty() ? "" : "+") + written[k].file;
    return outfit;
}

std::string program(const ImportOptions& options, const std::string& name) {
    return shell_word(options.programs + name);
}

/// The two programs that show and bake a garment on the character.
std::string character_text(const ImportOptions& options, const GarmentImport& import,
                           const std::string& garment, const GarmentSupport& support) {
    std::string scene =
        " --character " + shell_word(options.character) +
        (options.skin.mesh_name.empty() ? "" : " --skin " + shell_word(options.skin.mesh_name));
    char number[64];
    if (options.skin.scale != 1.0) {
        std::snprintf(number, sizeof number, " --character-scale %.9g", options.skin.scale);
        scene += number;
    }
    scene += " --garment " + shell_word(garment);
    if (import.clearance < options.import.clearance) {
        std::snprintf(number, sizeof number, " --clearance %g", import.clearance);
        scene += number;
    }
    if (support.kind == GarmentSupport::Kind::pins && support.can_be_pinned()) {
        std::snprintf(number, sizeof number, " --pin %.3f %.3f", support.pin_low, support.pin_high);
        scene += number;
    }
    return "  " + program(options, "viewer") + scene + "\n  " + program(options, "bake") + scene +
           " --out out/cloth.pc2 --body out/body.pc2\n";
}

std::string next_text(const ImportOptions& options, const GarmentImport& import,
                      const std::vector<WrittenGarment>& written, const TriMesh& skin) {
    const std::string head = "next\n", outfit = outfit_name(import, written, skin);
    if (options.character.empty())
        return head + "  " + program(options, "compare") + " --garment " + shell_word(outfit) +
               " --body " + options.body + "\n  " + program(options, "bake") + " --garment " +
               shell_word(outfit) + " --out out/cloth.pc2 --body out/body.pc2\n";
    // Pins between heights would hold the other garments there, too.
    const bool one_by_one = std::any_of(
        import.garments.begin(), import.garments.end(),
        [](const auto& garment) { return garment.support.kind == GarmentSupport::Kind::pins; });
    if (!one_by_one)
        return head + character_text(options, import, outfit, import.garments[0].support);
    std::string text = head;
    for (size_t k = 0; k < written.size(); ++k)
        text += character_text(options, import, written[k].file, import.garments[k].support);
    return text;
}

}  // namespace

nlohmann::ordered_json import_json(const ImportOptions& options, const GarmentImport& import,
                                   const std::vector<WrittenGarment>& written) {
    nlohmann::ordered_json garments = nlohmann::ordered_json::array();
    for (size_t k = 0; k < written.size(); ++k)
        garments.push_back(garment_json(import.garments[k], written[k]));
    const Eigen::RowVector3d low = import.read.vertices.colwise().minCoeff(),
                             high = import.read.vertices.colwise().maxCoeff();
    return {{"file", options.file},
            {"character", options.character.empty() ? nlohmann::ordered_json()
                                                    : nlohmann::ordered_json(options.character)},
            {"body", options.character.empty() ? nlohmann::ordered_json(options.body)
                                               : nlohmann::ordered_json()},
            {"metres_per_unit", options.scale},
            {"read",
             {{"vertices", import.read.vertices.rows()},
              {"faces", import.read.faces.rows()},
              {"low_m", {low.x(), low.y(), low.z()}},
              {"high_m", {high.x(), high.y(), high.z()}}}},
            {"changes", import.changes},
            {"warnings", import.warnings},
            {"garments", garments}};
}

std::string import_text(const ImportOptions& options, const GarmentImport& import,
                        const std::vector<WrittenGarment>& written, const TriMesh& skin) {
    const Eigen::RowVector3d size =
        import.read.vertices.colwise().maxCoeff() - import.read.vertices.colwise().minCoeff();
    std::string text = line("%s: %d vertices, %d faces, %.2f x %.2f x %.2f m (1 unit = %.6g m)",
                            options.file.c_str(), static_cast<int>(import.read.vertices.rows()),
                            static_cast<int>(import.read.faces.rows()), size.x(), size.y(),
                            size.z(), options.scale);
    text += joined(import.changes, "changed: ");
    text += joined(import.warnings, "warning: ");
    for (size_t k = 0; k < written.size(); ++k)
        text += garment_text(import.garments[k], written[k]);
    return text + next_text(options, import, written, skin);
}

}  // namespace cloth
