// lookbook: garments on bodies in motion, as pictures and films. See --help.
#include <omp.h>

#include <cstdio>

#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "demos/lookbook/lookbook.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

using namespace cloth;

namespace {

void run(const LookbookOptions& options) {
    if (options.threads > 0) omp_set_num_threads(options.threads);
    Progress line;
    const nlohmann::ordered_json rows = make_lookbook(
        options,
        [&line](int done, int all, const std::string& what) { line.update(done, all, what); });
    const nlohmann::ordered_json document = {{"provenance", provenance_json(omp_get_max_threads())},
                                             {"rows", rows}};
    write_text_file(options.out + "/lookbook.json", document.dump(1) + "\n");
    for (const auto& row : rows)
        if (!row.at("failure").is_null())
            std::printf("%s on the body %s: %s\n", row.at("garment").get<std::string>().c_str(),
                        row.at("body").get<std::string>().c_str(),
                        row.at("failure").get<std::string>().c_str());
    std::printf("%s/lookbook.png, lookbook.json%s\n", options.out.c_str(),
                options.video ? ", and a film of each body" : "");
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        remove_temporary_files_at_signals();
        run(parse_lookbook_options(arguments));
    });
}
