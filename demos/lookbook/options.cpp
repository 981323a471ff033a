#include "demos/lookbook/options.h"

#include <CLI/CLI.hpp>

#include "demos/compare/body_named.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"

namespace cloth {

LookbookOptions parse_lookbook_options(const std::vector<std::string>& arguments) {
    LookbookOptions options;
    bool no_video = false;
    CLI::App app("lookbook: garments on bodies in motion, as pictures and films", "lookbook");
    set_up(app);
    add_list(app, "--garments", options.garments,
             "as --garment of compare takes them (default: one of each, and an\noutfit)");
    add_list(app, "--bodies", options.bodies,
             "default, slight, heavy, or numbers, of which each is a sampled\nshape (default: the "
             "three, or the first without shared data)");
    app.add_option("--motion", options.motion, "01_01 (default), a clip's number or a BVH file")
        ->type_name("NAME");
    app.add_option("--solver", options.solver, "as compare takes it (default small, as shipped)")
        ->type_name("NAME");
    add_whole_number(app, "--frames", options.frames, 0, 100000,
                     "of 1/30 s (default 0: the whole motion)");
    add_whole_number(app, "--picture", options.picture, 0, 100000,
                     "frame of the picture (default 71), the last one at most");
    add_whole_number(app, "--threads", options.threads, 0, 256, "0: all cores (default)");
    app.add_flag("--no-video", no_video, "the picture and the figures only");
    app.add_option("--out", options.out, "folder (default out/lookbook)")->type_name("DIR");
    app.footer(
        "Writes lookbook.png (a row for each body, and above them the garments as they are put\n"
        "on), BODY.mp4, and lookbook.json: of each garment on each body the largest stretch and\n"
        "depth of a frame, and whether it was lost or torn.");
    parse(app, arguments);
    for (const std::string& garment : options.garments) check_garment_name(garment);
    for (const std::string& body : options.bodies) body_shape_named(body);
    options.video = !no_video;
    return options;
}

}  // namespace cloth
