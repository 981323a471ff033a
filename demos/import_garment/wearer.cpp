#include "demos/import_garment/wearer.h"

#include <cstdio>

#include "data/authoring/garment_support.h"
#include "data/body/body_shapes.h"
#include "data/body/garment_place.h"
#include "data/body/welded_character.h"
#include "data/core/errors.h"
#include "data/core/mesh_repair.h"
#include "data/core/weld.h"
#include "data/files/mesh_io.h"
#include "data/files/mhclo.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_named.h"
#include "demos/dressing_checks.h"

namespace cloth {
namespace {

std::string size_text(const Points& x) {
    const Eigen::RowVector3d low = x.colwise().minCoeff(), high = x.colwise().maxCoeff();
    char text[160];
    std::snprintf(text, sizeof text,
                  "x from %.3g to %.3g, y from %.3g to %.3g, z from %.3g to %.3g", low.x(),
                  high.x(), low.y(), high.y(), low.z(), high.z());
    return text;
}

/// The move that puts a garment for a person who stands on the origin, or whose middle is there, as
/// MakeHuman has it, on this one.
std::string move_text(const Points& garment, const TriMesh& skin) {
    const double low = skin.vertices.col(1).minCoeff(), high = skin.vertices.col(1).maxCoeff();
    // What was made for one who stands on the origin is hardly below it.
    const bool middle = garment.col(1).minCoeff() < -0.05 * (high - low);
    const VectorX areas = face_area_vectors(skin.vertices, skin.faces).rowwise().norm();
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (Eigen::Index f = 0; f < areas.size(); ++f)
        for (int c = 0; c < 3; ++c)
            centre += areas[f] / (3.0 * areas.sum()) * skin.vertices.row(skin.faces(f, c));
    char text[200];
    std::snprintf(
        text, sizeof text,
        "--move %.2f %.2f %.2f brings what was made for a person %s the origin about here",
        centre.x(), middle ? 0.5 * (low + high) : low, centre.z(),
        middle ? "with the middle at" : "who stands on");
    return text;
}

/// What is said of a garment that is elsewhere.
[[noreturn]] void refuse_place(const ImportOptions& options, const Points& in_file,
                               const TriMesh& mesh, const TriMesh& skin) {
    const Points& garment = mesh.vertices;
    std::string remedy;
    for (const PlaceGuess& guess : guess_place(in_file, skin.vertices))
        remedy += (remedy.empty() ? "" : ", or ") + std::string("--unit ") + guess.unit.name +
                  (guess.z_up ? " --up z" : "") + " if the file is in " + guess.unit.plural +
                  (guess.z_up ? " with z up" : "");
    if (remedy.empty()) {
        remedy = "give --unit or --scale, --up and --move, or export both files from one scene; ";
        const std::vector<LengthUnit> sizes = plausible_sizes(in_file, skin.vertices);
        for (const LengthUnit& unit : sizes)
            remedy += std::string("in ") + unit.plural + " its size would fit, ";
        remedy += move_text(garment, skin);
        if (lies_on_its_side(repair_mesh(weld_mesh(mesh, options.import.weld).mesh).mesh))
            remedy +=
                ". Its openings look sideways: if it lies on its side, turn it upright in a mesh "
                "editor";
    }
    throw ArgumentError(options.file,
                        "it is not where the character is: " + size_text(garment) +
                            " m; the character: " + size_text(skin.vertices) + " m",
                        remedy);
}

TriMesh load_makehuman_clothes(const ImportOptions& options) {
    if (!options.character.empty())
        throw UsageError(options.file +
                         ": it fits MakeHuman's body, and --character is another one; leave "
                         "--character out, or give the OBJ file of the clothes on this character");
    const MhcloFile clothes = load_mhclo(options.file);
    const std::optional<BodyShapes> shapes = BodyShapes::load_shared();
    if (!shapes)
        throw LoadError(options.file, "", "MakeHuman's base mesh is needed, and not there",
                        "put its base.obj and targets into body_makehuman of the folder that "
                        "CLOTH_SHARED_DATA names");
    return load_mhclo_mesh(clothes, shapes->base_mesh(body_shape_named(options.body)));
}

bool is_mhclo(const std::string& file) {
    const std::string ending = ".mhclo";
    return file.size() > ending.size() &&
           file.compare(file.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace

Wearer load_wearer(const ImportOptions& options) {
    if (options.character.empty()) {
        Wearer wearer{"the body " + options.body, {}, body_named(options.body)};
        wearer.skin = wearer.body->rest_mesh();
        return wearer;
    }
    const WeldedCharacter character(options.character, options.skin, options.character_weld);
    check_height(options.character, character);
    check_surface(options.character, character);
    return {options.character, character.rest(), nullptr};
}

PaintedMesh load_clothes(const ImportOptions& options, const Wearer& wearer) {
    if (is_mhclo(options.file)) return {load_makehuman_clothes(options), {}, false};
    PaintedMesh painted =
        load_painted_mesh(options.file, options.mesh, FacesWithoutArea::keep, options.goal_colours);
    TriMesh& mesh = painted.mesh;
    const Points in_file = mesh.vertices;
    if (options.z_up) mesh.vertices = with_y_up(mesh.vertices);
    mesh.vertices *= options.scale;
    mesh.vertices.rowwise() += options.move.transpose();
    if (!is_in_place(mesh.vertices, wearer.skin.vertices))
        refuse_place(options, in_file, mesh, wearer.skin);
    return painted;
}

}  // namespace cloth
