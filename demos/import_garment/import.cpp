#include "demos/import_garment/import.h"

#include <filesystem>
#include <set>

#include "data/body/garment_fit.h"
#include "data/core/carry_over.h"
#include "data/files/make_folder.h"
#include "data/files/mesh_io.h"
#include "data/files/painted_mesh.h"
#include "demos/import_garment/picture.h"
#include "demos/import_garment/report.h"
#include "demos/import_garment/wearer.h"
#include "render/replaced_file.h"

namespace cloth {
namespace {

/// The names of the files: with the sort of garment, if there are several.
std::vector<std::string> file_names(const ImportOptions& options, const GarmentImport& import) {
    std::vector<std::string> names;
    std::set<std::string> taken;
    for (const ImportedGarment& garment : import.garments) {
        std::string name = options.name;
        if (import.garments.size() > 1) name += "_" + garment.support.sort;
        const std::string first = name;
        for (int k = 2; !taken.insert(name).second; ++k) name = first + std::to_string(k);
        names.push_back(options.out + "/" + name);
    }
    return names;
}

/// What is painted on the mesh that was read, at the vertices of what was made of it.
std::vector<GoalLimits> carried_limits(GarmentImport& import, const PaintedMesh& painted) {
    if (painted.unread_colours)
        import.warnings.push_back(
            "it has vertex colours, which are not read. --goal-colours M reads them as goals");
    std::vector<GoalLimits> limits(import.garments.size());
    if (painted.limits.empty()) return limits;
    for (size_t k = 0; k < limits.size(); ++k)
        limits[k] = limits_at(import.garments[k].worn.vertices, painted.mesh, painted.limits);
    import.changes.push_back("the goals that are painted on it were carried over, into a PLY file");
    return limits;
}

/// Garments are kept for the body default, from which fit_outfit() takes them to others.
void carry_to_default(ImportedGarment& garment, const Body& from, double clearance,
                      const std::string& file) {
    GarmentFitSettings settings;
    settings.clearance = clearance;
    settings.garment_name = file;
    const Points worn =
        fit_garment(garment.worn, from.rest_mesh(), Body::load_default().rest(), settings);
    garment.rest += worn - garment.worn.vertices;
    garment.worn.vertices = worn;
}

}  // namespace

ImportResult import_file(const ImportOptions& options) {
    const Wearer wearer = load_wearer(options);
    const PaintedMesh painted = load_clothes(options, wearer);
    GarmentImport import = import_garment(painted.mesh, wearer.skin, options.import);
    const std::vector<GoalLimits> limits = carried_limits(import, painted);
    const Image picture = options.picture ? import_picture(import, wearer.skin) : Image();

    make_folder(options.out);
    ImportResult result;
    std::vector<WrittenGarment> written;
    const std::vector<std::string> names = file_names(options, import);
    for (size_t k = 0; k < names.size(); ++k) {
        ImportedGarment& garment = import.garments[k];
        if (wearer.body && options.body != "default")
            carry_to_default(garment, *wearer.body, options.import.clearance, options.file);
        written.push_back({names[k] + (limits[k].empty() ? ".obj" : ".ply"), ""});
        const TriMesh rest{garment.rest, garment.worn.faces};
        if (limits[k].empty())
            save_obj(written[k].file, rest);
        else
            save_painted_ply(written[k].file, rest, limits[k]);
        const std::string worn = names[k] + ".worn.obj";
        std::error_code none;
        std::filesystem::remove(worn, none);  // of an earlier import
        if (!garment.support.upper_edge.empty()) {
            written[k].worn_file = worn;
            save_obj(worn, garment.worn);
        }
        result.files.push_back(written[k].file);
    }
    result.json = import_json(options, import, written);
    result.text = import_text(options, import, written, wearer.skin);
    const std::string prefix = options.out + "/" + options.name + ".import";
    write_text_file(prefix + ".json", result.json.dump(1) + "\n");
    write_text_file(prefix + ".txt", result.text);
    if (!picture.empty()) write_png(prefix + ".png", picture);
    return result;
}

}  // namespace cloth
