#include "demos/viewer/options.h"

#include <CLI/CLI.hpp>

#include "data/files/vertex_order.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_named.h"
#include "demos/compare/command_line.h"

namespace cloth {
namespace {

void add_start(CLI::App& app, ViewerOptions& options) {
    app.add_flag("--paused", options.paused, "nothing moves until you let it");
    app.add_option("--colours", options.colours, "what the cloth's colours show at the start")
        ->check(CLI::IsMember({"garments", "stretch", "contact"}).description(""))
        ->type_name("garments|stretch|contact");
    add_number(app, "--wind", options.wind, 0.0, 20.0, "its speed at the start (m/s), 0 to 20")
        ->type_name("SPEED");
    app.add_flag("--wireframe", options.wireframe, "the edges of the cloth are shown");
}

void add_window(CLI::App& app, ViewerOptions& options) {
    add_whole_number(app, "--width", options.width, 320, 7680, "of the window (pixels)");
    add_whole_number(app, "--height", options.height, 240, 4320, "of the window (pixels)");
    add_whole_number(app, "--threads", options.threads, 0, 256, "0: all cores");
    add_whole_number(app, "--frames", options.frames, 0, 1000000,
                     "end after so many steps (default 0: when the window is closed)");
    app.add_option("--screenshot", options.screenshot, "write the last picture there, as PNG")
        ->type_name("FILE");
}

}  // namespace

ViewerOptions parse_viewer_options(const std::vector<std::string>& arguments) {
    ViewerOptions options;
    CLI::App app("viewer: a window with a garment on a moving body, to look at and play with",
                 "viewer");
    set_up(app);
    add_scene(app, options.scene);
    add_body(app, options.scene.shape)->excludes(app.get_option("--character"));
    add_start(app, options);
    add_window(app, options);
    app.footer(
        "Keys: space plays and pauses, N makes one step, R restarts, W shows edges, C changes\n"
        "the colours, Escape ends. The left mouse button drags cloth, or turns the camera where\n"
        "there is none; the middle one, or shift, moves it; the wheel brings it nearer.");
    parse(app, arguments);
    finish_scene(options.scene);
    body_shape_named(options.scene.shape);
    if (!options.screenshot.empty() && extension_of(options.screenshot) != "png")
        throw UsageError("--screenshot " + options.screenshot +
                         ": it is written as PNG; give a name that ends with .png");
    if (options.paused && options.frames > 0)
        throw UsageError("--frames: leave out --paused, or there will be no steps to count");
    return options;
}

}  // namespace cloth
