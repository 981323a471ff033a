// viewer: a window with a garment on a moving body, to look at and play with.
#include <omp.h>

#include "demos/compare/command_line.h"
#include "demos/viewer/options.h"
#include "demos/viewer/window.h"

using namespace cloth;

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        const ViewerOptions options = parse_viewer_options(arguments);
        if (options.threads > 0) omp_set_num_threads(options.threads);
        run_viewer(options);
    });
}
