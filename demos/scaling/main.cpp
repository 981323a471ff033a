// scaling: time and memory of solvers against the number of vertices. See --help.

#include <cstdio>

#include "data/files/make_folder.h"
#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "demos/provenance/provenance.h"
#include "demos/scaling/options.h"
#include "demos/scaling/scaling_run.h"
#include "demos/speed_error/pinning.h"
#include "render/replaced_file.h"

using namespace cloth;

namespace {

void write_report(const ScalingOptions& options, int threads, const std::vector<ScalingRow>& rows) {
    nlohmann::ordered_json document = {{"provenance", provenance_json(threads)},
                                       {"rows", nlohmann::ordered_json::array()}};
    for (const ScalingRow& row : rows) document["rows"].push_back(to_json(row));
    write_text_file(options.out + "/scaling.json", document.dump(1) + "\n");
    write_text_file(options.out + "/scaling.svg", scaling_plot(rows, threads));
}

void scaling(const ScalingOptions& options) {
    const int threads = static_cast<int>(pin_threads(options.threads).size());
    ScalingSettings settings;
    settings.solvers = options.solvers;
    settings.solver.threads = threads;
    settings.warm_up = options.warm_up;
    make_folder(options.out);
    Progress line;
    std::vector<ScalingRow> rows;
    for (const std::string& scene : options.scenes)
        for (const int vertices : options.vertices) {
            const std::vector<ScalingRow> size = measure_size(
                {scene, vertices, options.warm_up + options.frames, options.out + "/garments"},
                settings,
                [&](int done, int all, const std::string& what) { line.update(done, all, what); });
            rows.insert(rows.end(), size.begin(), size.end());
            write_report(options, threads, rows);
        }
    std::printf("%s/scaling.json and .svg\n", options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        scaling(parse_scaling_options(arguments));
    });
}
