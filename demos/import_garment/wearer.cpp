#include "demos/import_garment/wearer.h"

#include <filesystem>

#include "data/body/body_shapes.h"
#include "data/body/garment_place.h"
#include "data/body/welded_character.h"
#include "data/core/errors.h"
#include "data/files/mesh_io.h"
#include "data/files/mhclo.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_named.h"
#include "demos/dressing_checks.h"
#include "demos/import_garment/place.h"

namespace cloth {
namespace {

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

/// Of a file that is both, all meshes would be the garment: the skin would be led out of itself,
/// and that takes long.
void check_own_mesh(const ImportOptions& options) {
    std::error_code none;
    if (options.character.empty() || !options.mesh.empty() ||
        !std::filesystem::equivalent(options.file, options.character, none))
        return;
    const std::vector<std::string> names = mesh_names(options.file);
    if (names.size() < 2)
        throw ArgumentError(options.file,
                            "it is garment and character at once, and has one mesh only",
                            "make the garment a mesh of its own in a mesh editor");
    throw ArgumentError(
        options.file,
        "it is garment and character at once; its meshes are " + join_list(names, ", "),
        "--mesh NAME for the one that is the garment, and --skin NAME for the one "
        "that is skin");
}

}  // namespace

Wearer load_wearer(const ImportOptions& options) {
    check_own_mesh(options);
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
    if (options.goal_colours && painted.limits.empty())
        throw ArgumentError(options.file, "it has no vertex colours, and --goal-colours reads them",
                            "export it with them, or leave --goal-colours out");
    TriMesh& mesh = painted.mesh;
    const Points in_file = mesh.vertices;
    if (options.z_up) mesh.vertices = with_y_up(mesh.vertices);
    mesh.vertices *= options.scale;
    mesh.vertices.rowwise() += options.move.transpose();
    check_place(options, in_file, mesh, wearer.skin);
    return painted;
}

}  // namespace cloth
