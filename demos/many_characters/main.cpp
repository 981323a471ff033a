// many_characters: dressed characters in one Bullet world, their garments stepped one after the
// other or at the same time. See --help.

#include <cstdio>

#include "data/files/make_folder.h"
#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "demos/many_characters/crowd_run.h"
#include "demos/provenance/provenance.h"
#include "demos/speed_error/pinning.h"
#include "render/replaced_file.h"

using namespace cloth;

namespace {

void many_characters(const ManyCharactersOptions& options) {
    const int threads = static_cast<int>(pin_threads(options.threads).size());
    make_folder(options.out);
    nlohmann::ordered_json document = {{"provenance", provenance_json(threads)},
                                       {"rows", nlohmann::ordered_json::array()}};
    Progress line;
    for (const std::string& solver : options.solvers) {
        for (const CrowdRow& row : measure_crowd(
                 options, solver,
                 [&](int done, int all, const std::string&what) { line.update(done, all, what); }))
            document["rows"].push_back(to_json(row));
        write_text_file(options.out + "/many_characters.json", document.dump(1) + "\n");
    }
    std::printf("%s/many_characters.json\n", options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        many_characters(parse_many_characters_options(arguments));
    });
}
