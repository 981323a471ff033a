#include "demos/paper_tables/options.h"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"

namespace cloth {
namespace {

const char* const explanations =
    "Writes paper_tables.json, paper_tables.md, figure_6.csv and .svg, and figure_7.svg.\n"
    "\n"
    "Each row is measured by itself: memory of the solver, a rollout, and single steps from\n"
    "the reference's states. It is kept in paper_tables.json as soon as it is done. The same\n"
    "command goes on; rows of another commit, number of frames or threads, or of other weights\n"
    "or files are measured anew. Networks without weights get a row that says so.\n"
    "\n"
    "Figure 7 is trained by train_series --series neighbours; its report is committed.";

}  // namespace

PaperOptions parse_paper_options(const std::vector<std::string>& arguments) {
    PaperOptions options;
    options.train =
        (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "train").string();
    bool no_training = false;
    CLI::App app("paper_tables: the tables and figures of FastClothGNN, measured here",
                 "paper_tables");
    set_up(app);
    add_list(app, "--garments", options.garments,
             "default tshirt,pants,dress, and tshirt_1000 for the network of\none garment");
    add_list(app, "--solvers", options.solvers, "as speed_error knows them (default: the paper's)");
    add_whole_number(app, "--frames", options.frames, 0, 100000,
                     "of 1/30 s (default 30, of the dress 12)");
    add_whole_number(app, "--threads", options.threads, 0, 256,
                     "each bound to a core of its own (0: all cores; default)");
    app.add_option("--weights", options.weights,
                   "folder with NAME.safetensors and NAME.csv (default: the\ncommitted ones)")
        ->type_name("DIR");
    app.add_option("--neighbours", options.neighbours,
                   "report of train_series (default: the committed one)")
        ->type_name("FILE");
    app.add_option("--train", options.train, "the program train (default: beside this one)")
        ->type_name("FILE");
    add_whole_number(app, "--training-iterations", options.training_iterations, 40, 100000,
                     "of the short trainings that cost and memory are measured with\n"
                     "(default 120)");
    app.add_flag("--no-training", no_training, "without these");
    app.add_flag("--again", options.again, "forget the rows that are there");
    app.add_option("--note", options.note, "of the circumstances, shown with the figures")
        ->type_name("TEXT");
    app.add_option("--references", options.references,
                   "where the references are kept, which take most of the time\n"
                   "(default: parts in --out)")
        ->type_name("DIR");
    app.add_option("--out", options.out, "(default out/paper_tables)")->type_name("DIR");
    app.footer(explanations);
    parse(app, arguments);
    for (const std::string& garment : options.garments) check_garment_name(garment);
    if (no_training) options.train.clear();
    if (options.references.empty()) options.references = options.out + "/parts";
    return options;
}

}  // namespace cloth
