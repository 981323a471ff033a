#include "demos/compare/report_html.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "data/core/errors.h"
#include "demos/compare/base64.h"
#include "demos/compare/report_plots.h"
#include "demos/compare/report_table.h"
#include "render/image.h"
#include "render/plot.h"

namespace cloth {

namespace {

using nlohmann::json;

constexpr char kStyle[] = R"(
body { font: 16px/1.5 "DejaVu Sans", Helvetica, Arial, sans-serif; color: #222; background: #fff;
       max-width: 1180px; margin: 0 auto; padding: 1em; }
h1 { margin-bottom: 0; } h2 { margin-top: 2em; border-bottom: 1px solid #ccc; }
.scene { color: #555; margin-top: 0; }
video, figure img { width: 100%; height: auto; } figure { margin: 1em 0; }
figure svg { max-width: 100%; height: auto; } figcaption { color: #555; font-size: 0.85em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 0.88em; }
th, td { padding: 0.3em 0.7em; text-align: right; border-bottom: 1px solid #ddd; }
tr:first-child th { vertical-align: bottom; border-bottom: 2px solid #888; }
th:first-child { text-align: left; white-space: nowrap; } th small { font-weight: normal; }
th i { display: inline-block; width: 0.8em; height: 0.8em; margin-right: 0.5em; }
tr:nth-child(odd) td, tr:nth-child(odd) th { background: #f7f7f7; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(540px, 100%), 1fr));
         gap: 0 2em; }
.failed { color: #b00; }
tr td.best { font-weight: bold; background: #cdeccf; }
dl { font-size: 0.85em; color: #444; display: grid; grid-template-columns: max-content auto;
     gap: 0 1em; } dt { font-weight: bold; } dd { margin: 0; }
)";

const std::vector<ReportColumn>& speed_columns() {
    static const std::vector<ReportColumn> columns = {
        {"time", "ms per frame", "/ms_per_frame/median", "Half of the frames took less than this."},
        {"slow frames", "ms per frame", "/ms_per_frame/p95", "One frame in twenty took more."},
        {"proximity", "ms", "/stages_ms/proximity",
         "Part of the time that went into finding the nearest points of the body.", false},
        {"features", "ms", "/stages_ms/features",
         "Part that went into preparing the network's input.", false},
        {"solve", "ms", "/stages_ms/solve", "Part that went into the network or the solver.",
         false},
        {"contact", "ms", "/stages_ms/contact",
         "Part that went into keeping the cloth outside of the body.", false},
        {"memory", "MB", "/peak_memory_mb",
         "Most memory in use, above what the process used before it made the solver."}};
    return columns;
}

const std::vector<ReportColumn>& one_step_columns() {
    static const std::vector<ReportColumn> columns = {
        {"gap", "", "/one_step/gap/median",
         "Energy above the minimum, as a part of that of the guess which all start from: 0 is "
         "converged, 1 no better than the guess (median over the frames)."},
        {"gap, bad frames", "", "/one_step/gap/p95", "One frame in twenty has a larger gap."},
        {"progress", "", "/one_step/progress/median",
         "The same, as a part of the energy of not moving at all: 1 is cloth that hangs frozen in "
         "the air."},
        {"error", "mm", "/one_step/rmse_mm",
         "Root of the mean squared distance of the vertices to the converged step."}};
    return columns;
}

const std::vector<ReportColumn>& energy_columns() {
    static const std::vector<ReportColumn> columns = [] {
        std::vector<ReportColumn> list;
        const std::pair<const char*, const char*> terms[] = {
            {"strain", "Energy of stretched and sheared cloth."},
            {"bending", "Energy of folds."},
            {"gravity", "Weight times height; only differences between solvers mean something."},
            {"inertia", "Deviation from going on straight ahead."},
            {"contact", "Penalty for cloth nearer to the body than 4 mm."},
            {"friction", "Work of sliding along the body."}};
        for (const auto& [name, meaning] : terms)
            list.push_back(
                {name, "mJ", std::string("/one_step/energy_terms/") + name, meaning, false, 1e3});
        return list;
    }();
    return columns;
}

const std::vector<ReportColumn>& rollout_columns() {
    static const std::vector<ReportColumn> columns = {
        {"error", "mm", "/rollout/rmse_mm",
         "Root of the mean squared distance to the reference's cloth at the same time step, mean "
         "over the frames that have a reference."},
        {"fine error", "mm", "/rollout/fine_rmse_mm",
         "The same to the cloth computed with a time step of 1/240 s, which is nearer to the "
         "truth."},
        {"gap", "", "/rollout/gap/median",
         "Energy gap of a step from the solver's own state, as in the table above."},
        {"gap, bad frames", "", "/rollout/gap/p95",
         "One frame in twenty of those tried has a larger gap."},
        {"progress", "", "/rollout/progress/median",
         "Progress of a step from the solver's own state, as in the table above."},
        {"inside, deepest", "mm", "/rollout/penetration/max_mm",
         "Deepest vertex below the body's skin in any frame."},
        {"inside", "%", "/rollout/penetration/fraction",
         "Part of the vertices below the skin, mean over all frames.", true, 100.0},
        {"stretch, middle", "", "/rollout/stretch/p50",
         "Length of the edges over their length at rest: median.", false},
        {"stretch, high", "", "/rollout/stretch/p99",
         "The same: one edge in a hundred is stretched more.", false},
        {"stretch, most", "", "/rollout/stretch/max",
         "The same: the most stretched edge of all frames.", false},
        {"jitter", "mm", "/rollout/jitter_mm",
         "Root of the mean squared change of the vertices' movement from frame to frame: shaking, "
         "and the acceleration that the motion asks for.",
         false}};
    return columns;
}

void check(const json& report) {
    const auto refuse = [](const std::string& field, const std::string& problem) {
        throw ArgumentError("report, field " + field, problem,
                            "pass a document as `compare` writes it to report.json");
    };
    if (!report.is_object()) refuse("/", "is no object");
    if (!report.contains("scene") || !report.at("scene").is_object())
        refuse("scene", "is missing or no object");
    if (!report.contains("solvers") || !report.at("solvers").is_array())
        refuse("solvers", "is missing or no list");
    for (const json& solver : report.at("solvers"))
        if (!solver.is_object() || !solver.contains("name") || !solver.at("name").is_string())
            refuse("solvers", "has an entry without a name");
}

std::string bytes_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)),
                            std::istreambuf_iterator<char>());
    if (!stream || bytes.empty())
        throw LoadError(path, "", "cannot be read or is empty", "make the pictures again");
    return bytes;
}

/// A value of the report as text; a dash where it is missing.
std::string text_at(const json& report, const std::string& path) {
    const json::json_pointer pointer(path);
    if (!report.contains(pointer) || report.at(pointer).is_null()) return "&ndash;";
    const json& value = report.at(pointer);
    if (value.is_string()) return escaped(value.get<std::string>());
    if (value.is_number()) return fixed_text(value.get<double>(), 3);
    return escaped(value.dump());
}

std::string scene_text(const json& report, const std::string& field) {
    return text_at(report, "/scene/" + field);
}

std::string heading_html(const json& report) {
    const double dt = number_at(report, "/scene/time_step");
    return "<h1>" + scene_text(report, "garment") + " on motion " + scene_text(report, "motion") +
           "</h1>\n<p class=\"scene\">" + scene_text(report, "vertices") + " vertices, " +
           scene_text(report, "faces") + " faces; " + scene_text(report, "frames") +
           " frames of 1/" + (dt > 0.0 ? fixed_text(1.0 / dt, 1) : "&ndash;") +
           " s; fabric: " + scene_text(report, "fabric") + "; " +
           text_at(report, "/provenance/machine") + ", " + text_at(report, "/provenance/threads") +
           " threads; commit " + text_at(report, "/provenance/commit") + "</p>\n";
}

/// The solver with the lowest value of those that compete; null if none has one.
const json* best_solver(const json& report, const std::string& path) {
    const json* best = nullptr;
    for (const json& solver : report.at("solvers")) {
        const double value = number_at(solver, path);
        if (!competes(solver) || std::isnan(value)) continue;
        if (!best || value < number_at(*best, path)) best = &solver;
    }
    return best;
}

/// "Fastest is <name>: <value> <unit>", or nothing where no solver has the value.
std::string winner_html(const json& report, const std::string& path, const std::string& praise,
                        const std::string& unit) {
    const json* best = best_solver(report, path);
    if (!best) return "";
    return "<li>" + praise + ": <b>" + escaped(best->at("name")) + "</b>, " +
           short_number(number_at(*best, path)) + " " + unit + "</li>\n";
}

std::string failures_html(const json& report) {
    std::string html;
    for (const json& solver : report.at("solvers")) {
        const double frame = number_at(solver, "/first_failed_frame");
        if (std::isnan(frame)) continue;
        const std::string how = solver.contains("failure") && solver.at("failure").is_string()
                                    ? ": " + solver.at("failure").get<std::string>()
                                    : "";
        html += "<li><b>" + escaped(solver.at("name")) + "</b> fails in frame " +
                fixed_text(frame, 0) + escaped(how) + "</li>\n";
    }
    return html.empty() ? "<li>No solver fails.</li>\n" : html;
}

std::string summary_html(const json& report) {
    return "<h2>In short</h2>\n<p>The same garment on the same moving body, stepped by " +
           std::to_string(report.at("solvers").size()) +
           " solvers, and held against a reference that solves every step until nothing changes "
           "any more. Of the solvers that do not fail (and apart from the reference):</p>\n<ul>\n" +
           winner_html(report, "/ms_per_frame/median", "Fastest", "ms per frame") +
           winner_html(report, "/one_step/gap/median", "Nearest to the minimum in a single step",
                       "of the guess's energy gap left") +
           winner_html(report, "/rollout/rmse_mm", "Nearest to the reference's cloth over time",
                       "mm off") +
           winner_html(report, "/rollout/fine_rmse_mm", "Nearest to the cloth of 1/240 s over time",
                       "mm off") +
           winner_html(report, "/rollout/penetration/max_mm", "Keeps out of the body best",
                       "mm deep at most") +
           failures_html(report) + "</ul>\n";
}

/// "key_frame_12.png" is "frame 12"; other names are as they are.
std::string caption_of(const std::string& path) {
    const std::string name = std::filesystem::path(path).stem().string();
    const std::string prefix = "key_frame_";
    if (name.compare(0, prefix.size(), prefix) != 0) return escaped(name);
    return "frame " + escaped(name.substr(prefix.size()));
}

/// Wide pictures are embedded at half their size: the page shows them no larger.
std::string png_of(const std::string& path) {
    Image image = read_png(path);
    while (image.width() > 2000) image = halved(image);
    const std::vector<std::uint8_t> png = encode_png(image);
    return {png.begin(), png.end()};
}

std::string pictures_html(const ReportPictures& pictures) {
    std::string html;
    if (!pictures.video.empty())
        html +=
            "<h2>Video</h2>\n<video controls loop muted playsinline "
            "src=\"data:video/mp4;base64," +
            base64(bytes_of(pictures.video)) + "\"></video>\n";
    if (!pictures.key_frames.empty()) html += "<h2>Key frames</h2>\n";
    for (const std::string& path : pictures.key_frames)
        html += "<figure><img alt=\"" + caption_of(path) + "\" src=\"data:image/png;base64," +
                base64(png_of(path)) + "\"><figcaption>" + caption_of(path) +
                "</figcaption></figure>\n";
    return html;
}

std::string tables_html(const json& report) {
    const json& solvers = report.at("solvers");
    return "<h2>Time and memory</h2>\n" + table_html(solvers, speed_columns()) +
           "<h2>Single steps from the reference's states</h2>\n"
           "<p>Every solver is given the same states, one after the other, and makes one step from "
           "each: what a step is worth, before errors add up.</p>\n" +
           table_html(solvers, one_step_columns()) +
           "<h3>Energy by term, mean of those steps</h3>\n" +
           table_html(solvers, energy_columns()) +
           "<h2>Rollout from its own states</h2>\n"
           "<p>Every solver goes on from what it made itself, as in a game: what its errors add up "
           "to.</p>\n" +
           table_html(solvers, rollout_columns());
}

const json* solver_named(const json& report, const std::string& name) {
    for (const json& solver : report.at("solvers"))
        if (solver.at("name") == name) return &solver;
    return nullptr;
}

bool has_bullet(const json& report) {
    for (const json& solver : report.at("solvers"))
        if (solver.at("name").get<std::string>().compare(0, 6, "bullet") == 0) return true;
    return false;
}

std::string notes_html(const json& report) {
    std::string html =
        "<h2>What these figures do not say</h2>\n<ul>\n"
        "<li>A small gap alone is not a good simulator: errors that the energy hardly sees add up "
        "from frame to frame. Read gap, progress and error together.</li>\n";
    const double frames = number_at(report, "/scene/frames");
    const double known = number_at(report, "/scene/reference_frames");
    if (known < frames)
        html += "<li>References are expensive: they cover the first " + fixed_text(known, 0) +
                " of " + fixed_text(frames, 0) +
                " frames. Errors and gaps are known for these only; times, penetration, stretch "
                "and jitter are of all frames.</li>\n";
    const json* reference = solver_named(report, "reference");
    const double off = reference ? number_at(*reference, "/rollout/fine_rmse_mm") : NAN;
    if (!std::isnan(off))
        html += "<li>The reference itself is " + short_number(off) +
                " mm off the cloth of 1/240 s: that is the error of the time step, not of a "
                "solver. A solver can be nearer to the fine cloth than the reference by "
                "accident.</li>\n";
    if (has_bullet(report))
        html +=
            "<li>Bullet's own cloth solves another model (springs and collision hulls, no such "
            "energy). Its gap and error say how far it is from this fabric, not how well it "
            "solves its own equations.</li>\n";
    return html +
           "<li>The minimum of a step is the lowest energy that the reference reaches. Where it "
           "is not quite converged a gap can come out slightly below 0.</li>\n"
           "<li>Times are wall-clock times: what else the machine did meanwhile is in them.</li>\n"
           "<li>Best values are marked among the solvers that do not fail; the reference does not "
           "take part, since the others are measured against it. A dash stands for what was not "
           "or could not be measured.</li>\n</ul>\n";
}

}  // namespace

std::string report_html(const json& report, const ReportPictures& pictures) {
    check(report);
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
           scene_text(report, "garment") + " on motion " + scene_text(report, "motion") +
           "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n" + heading_html(report) +
           summary_html(report) + pictures_html(pictures) + tables_html(report) +
           "<h2>Diagrams</h2>\n<div class=\"plots\">\n" + plots_html(report) + "</div>\n" +
           notes_html(report) + "</body>\n</html>\n";
}

}  // namespace cloth
