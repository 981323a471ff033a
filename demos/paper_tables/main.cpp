// paper_tables: the tables and figures of FastClothGNN, measured here. See --help.

#include <cstdio>

#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "demos/paper_tables/paper_run.h"
#include "demos/speed_error/pinning.h"

using namespace cloth;

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        const PaperOptions options = parse_paper_options(arguments);
        const int threads = static_cast<int>(pin_threads(options.threads).size());
        Progress line(stderr);
        run_paper_tables(options, threads, [&](int done, int all, const std::string& what) {
            line.update(done, all, what);
        });
        std::printf("%s/paper_tables.md, .json, figure_6.csv, .svg and figure_7.svg\n",
                    options.out.c_str());
    });
}
