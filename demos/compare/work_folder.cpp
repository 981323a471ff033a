#include "demos/compare/work_folder.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "data/files/make_folder.h"
#include "demos/compare/input_files.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

namespace cloth {
namespace {

using nlohmann::json;

/// All that the parts depend on, but for what solvers are made of.
json scene_record(const CompareOptions& options) {
    return {{"commit", build_commit()},
            {"garment", options.garment},
            {"body", options.body},
            {"motion", options.motion},
            {"fabric", options.fabric},
            {"rate", options.rate},
            {"frames", options.frames},
            {"reference_frames", options.reference_frames},
            {"threads", options.threads},
            {"weights", options.weights},
            {"files", files_key(scene_files(options.garment, options.motion))}};
}

json read_record(const std::string& path) {
    if (!std::filesystem::exists(path)) return json::object();
    json record = json::parse(read_file(path), nullptr, false);
    if (!record.is_object())
        throw LoadError(path, "", "is not a JSON object", "delete it; it is computed again");
    return record;
}

}  // namespace

std::string work_file(const CompareOptions& options, const std::string& name) {
    std::string file = name;
    std::replace(file.begin(), file.end(), '/', '_');
    return options.out + "/parts/" + file;
}

void prepare_work_folder(const CompareOptions& options) {
    make_folder(options.out);
    const std::string path = work_file(options, "settings.json");
    const json before = read_record(path), scene = scene_record(options);
    json solvers = json::object();
    std::error_code ignored;
    if (before.value("scene", json()) != scene)
        std::filesystem::remove_all(options.out + "/parts", ignored);
    else if (before.contains("solvers") && before.at("solvers").is_object())
        solvers = before.at("solvers");
    for (const std::string& solver : options.solvers) {
        const json files = files_key(solver_files(solver, options.weights));
        if (solvers.value(solver, json()) != files)
            for (const char* const ending : {".traj", ".json"})
                std::filesystem::remove(work_file(options, solver + ending), ignored);
        solvers[solver] = files;
    }
    make_folder(options.out + "/parts");
    write_text_file(path, json{{"scene", scene}, {"solvers", solvers}}.dump(1));
}

}  // namespace cloth
