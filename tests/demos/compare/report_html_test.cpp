#include "demos/compare/report_html.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "data/core/errors.h"
#include "demos/compare/base64.h"
#include "demos/compare/report_table.h"
#include "render/image.h"
#include "tests/render/temporary_folder.h"

namespace cloth::test {
namespace {

using nlohmann::json;

/// A solver's entry as `compare` writes it; all figures grow with `error`.
json solver_entry(const std::string& name, double ms, double error) {
    const json series = {{"ms", {ms, 1.1 * ms, 0.9 * ms}},
                         {"rmse_mm", {error, 2 * error, nullptr}},
                         {"fine_rmse_mm", {error + 5, 2 * error + 5, nullptr}},
                         {"penetration_mm", {0.0, 1.0, 0.5}},
                         {"stretch_p99", {1.1, 1.2, 1.15}},
                         {"gap_frames", {1}},
                         {"gap", {0.3}}};
    const json terms = {{"strain", 0.5},   {"bending", 0.01}, {"gravity", 2.0},
                        {"inertia", 0.25}, {"contact", 0.03}, {"friction", 0.004}};
    const json one_step = {{"gap", {{"median", error / 50}, {"p95", error / 25}}},
                           {"progress", {{"median", error / 100}}},
                           {"rmse_mm", error / 10},
                           {"energy_terms", terms},
                           {"gap_per_frame", {error / 50, error / 40}}};
    const json rollout = {{"gap", {{"median", error / 40}, {"p95", error / 20}}},
                          {"progress", {{"median", error / 90}}},
                          {"rmse_mm", error},
                          {"fine_rmse_mm", error + 5},
                          {"penetration", {{"max_mm", error / 8}, {"fraction", 0.015}}},
                          {"stretch", {{"p50", 1.02}, {"p99", 1.31}, {"max", 1.87}}},
                          {"jitter_mm", 0.7}};
    return {
        {"name", name},
        {"ms_per_frame", {{"median", ms}, {"p95", 1.5 * ms}}},
        {"stages_ms",
         {{"proximity", 0.2 * ms}, {"features", 0.1 * ms}, {"solve", 0.6 * ms}, {"contact", 0}}},
        {"peak_memory_mb", 50.0},
        {"finite", true},
        {"first_failed_frame", nullptr},
        {"failure", nullptr},
        {"one_step", one_step},
        {"rollout", rollout},
        {"series", series}};
}

json sample_report() {
    json failed = solver_entry("fast+0", 9.0, 0.5);
    failed["first_failed_frame"] = 41;
    failed["failure"] = "torn: 1 % of the edges are stretched beyond 2";
    return {
        {"scene",
         {{"garment", "tshirt"},
          {"vertices", 4012},
          {"faces", 7800},
          {"motion", "01_01"},
          {"frames", 90},
          {"reference_frames", 30},
          {"time_step", 1.0 / 30.0},
          {"fabric", "soft cotton, 33 N/m"}}},
        {"provenance",
         {{"commit", "0123456789"}, {"machine", "Two-core <processor>"}, {"threads", 2}}},
        {"solvers",
         {solver_entry("bullet", 21.0, 77.0), solver_entry("reference", 3100.0, 0.0),
          solver_entry("quasi-newton-3", 33.0, 14.2), solver_entry("fast", 46.0, 8.4), failed}}};
}

int count_of(const std::string& text, const std::string& part) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

/// The part of the page between a heading and the next one of the same level.
std::string section(const std::string& html, const std::string& heading) {
    const std::size_t start = html.find("<h2>" + heading + "</h2>");
    if (start == std::string::npos) return "";
    return html.substr(start, html.find("<h2>", start + 4) - start);
}

TEST(Base64, EqualsTheExamplesOfRfc4648) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foob"), "Zm9vYg==");
    EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64(std::string("\xFF\xFE\x00", 3)), "//4A");
}

TEST(ReportTable, NumbersHaveThreeDigits) {
    EXPECT_EQ(short_number(3141.6), "3142");
    EXPECT_EQ(short_number(31.416), "31.4");
    EXPECT_EQ(short_number(3.1416), "3.14");
    EXPECT_EQ(short_number(0.31416), "0.314");
    EXPECT_EQ(short_number(0.1), "0.100");
    EXPECT_EQ(short_number(9.996), "10.0");
    EXPECT_EQ(short_number(0.0), "0");
    EXPECT_EQ(short_number(-2.5e-5), "-2.5&middot;10<sup>-5</sup>");
    EXPECT_EQ(short_number(std::nan("")), "&ndash;");
}

TEST(ReportTable, MarksTheLowestOfThoseThatCompete) {
    const json report = sample_report();
    const std::string html = table_html(
        report.at("solvers"), {{"error", "mm", "/rollout/rmse_mm", "Distance to the reference."}});
    EXPECT_NE(html.find("fails in frame 41"), std::string::npos);
    // Neither the reference (0) nor the solver that failed (0.5) takes part.
    EXPECT_EQ(count_of(html, "class=\"best\""), 1);
    EXPECT_NE(html.find("<td class=\"best\">8.40</td>"), std::string::npos) << html;
    EXPECT_NE(html.find("Distance to the reference."), std::string::npos);
}

TEST(ReportTable, MissingAndNullNumbersAreDashes) {
    json report = sample_report();
    report["solvers"][0]["rollout"]["rmse_mm"] = nullptr;
    report["solvers"][2].erase("rollout");
    const std::string html =
        table_html(report.at("solvers"), {{"error", "mm", "/rollout/rmse_mm", "x"}});
    EXPECT_EQ(count_of(html, "<td>&ndash;</td>"), 2);
    EXPECT_EQ(count_of(html, "class=\"best\""), 0) << "nobody to compete with";
}

TEST(ReportHtml, ShowsSceneSummaryAndEverySolverInEveryTable) {
    const std::string html = report_html(sample_report(), {});
    for (const char* text : {"tshirt on motion 01_01", "4012 vertices", "90 frames of 1/30 s",
                             "soft cotton, 33 N/m", "2 threads"})
        EXPECT_NE(html.find(text), std::string::npos) << text;
    for (const char* heading : {"Time and memory", "Single steps from the reference's states",
                                "Rollout from its own states"})
        for (const char* name : {"bullet", "reference", "quasi-newton-3", "fast", "fast+0 "})
            EXPECT_NE(section(html, heading).find(std::string("</i>") + name), std::string::npos)
                << heading << ": " << name;
    const std::string summary = section(html, "In short");
    EXPECT_NE(summary.find("Fastest: <b>bullet</b>, 21.0 ms"), std::string::npos) << summary;
    EXPECT_NE(summary.find("over time: <b>fast</b>, 8.40 mm"), std::string::npos) << summary;
    EXPECT_NE(summary.find("<b>fast+0</b> fails in frame 41: torn"), std::string::npos) << summary;
}

TEST(ReportHtml, UnitsAreThoseOfTheColumns) {
    json report = sample_report();
    report["solvers"][0]["rollout"]["penetration"]["fraction"] = 0.0421;
    report["solvers"][0]["one_step"]["energy_terms"]["bending"] = 0.0567;
    const std::string html = report_html(report, {});
    EXPECT_NE(section(html, "Rollout from its own states").find(">4.21</td>"), std::string::npos)
        << "a fraction is shown in percent";
    EXPECT_NE(html.find(">56.7</td>"), std::string::npos) << "joule are shown in millijoule";
}

TEST(ReportHtml, NotesFollowTheReport) {
    json report = sample_report();
    report["solvers"][1]["rollout"]["fine_rmse_mm"] = 23.4;
    std::string notes = section(report_html(report, {}), "What these figures do not say");
    EXPECT_NE(notes.find("the first 30 of 90 frames"), std::string::npos) << notes;
    EXPECT_NE(notes.find("itself is 23.4 mm off"), std::string::npos) << notes;
    EXPECT_NE(notes.find("Bullet's own cloth"), std::string::npos);
    report["scene"]["reference_frames"] = 90;
    report["solvers"].erase(0);
    notes = section(report_html(report, {}), "What these figures do not say");
    EXPECT_EQ(notes.find("References are expensive"), std::string::npos);
    EXPECT_EQ(notes.find("Bullet"), std::string::npos);
}

TEST(ReportHtml, DrawsADiagramForEverySeriesThatIsThere) {
    json report = sample_report();
    const int all = count_of(report_html(report, {}), "<svg");
    EXPECT_EQ(all, 7);
    for (json& solver : report["solvers"]) solver["series"].erase("stretch_p99");
    EXPECT_EQ(count_of(report_html(report, {}), "<svg"), all - 1);
    for (json& solver : report["solvers"]) solver.erase("series");
    EXPECT_EQ(count_of(report_html(report, {}), "<svg"), 2) << "time against error, and gaps";
}

TEST(ReportHtml, PicturesAreInsideThePage) {
    const TemporaryFolder folder;
    const std::string video = folder.write("a.mp4", "not really a video");
    const std::string key_frame = folder.file("key_frame_12.png");
    write_png(key_frame, Image(2400, 10, {1, 2, 3}));
    ReportPictures pictures;
    pictures.video = video;
    pictures.key_frames = {key_frame};
    const std::string html = report_html(sample_report(), pictures);
    EXPECT_NE(html.find("data:video/mp4;base64," + base64("not really a video")),
              std::string::npos);
    EXPECT_NE(html.find("frame 12"), std::string::npos);
    const auto half = encode_png(Image(1200, 5, {1, 2, 3}));
    EXPECT_NE(html.find(base64({half.begin(), half.end()})), std::string::npos)
        << "wide pictures are embedded at half their size";
    for (const char* outside : {"http://www.w3", "https://", "src=\"/", "<script", "@import"})
        EXPECT_LE(count_of(html, outside), std::string(outside) == "http://www.w3" ? 7 : 0);
}

TEST(ReportHtml, TextOfTheReportIsEscaped) {
    json report = sample_report();
    report["solvers"][0]["name"] = "<img src=x>";
    const std::string html = report_html(report, {});
    EXPECT_EQ(html.find("<img src=x>"), std::string::npos);
    EXPECT_NE(html.find("Two-core &lt;processor&gt;"), std::string::npos);
}

TEST(ReportHtml, ARunInWhichNothingWasMeasuredIsStillAPage) {
    json report = {{"scene", json::object()}, {"solvers", json::array({{{"name", "bullet"}}})}};
    const std::string html = report_html(report, {});
    EXPECT_EQ(count_of(html, "</html>"), 1);
    EXPECT_EQ(count_of(html, "<svg"), 0);
    EXPECT_EQ(html.find("nan"), std::string::npos);
    report["solvers"] = json::array();
    EXPECT_EQ(count_of(report_html(report, {}), "</html>"), 1);
}

TEST(ReportHtml, EqualReportsGiveEqualPages) {
    EXPECT_EQ(report_html(sample_report(), {}), report_html(sample_report(), {}));
}

TEST(ReportHtml, UnusableInputIsRefusedByName) {
    const json good = sample_report();
    for (const char* field : {"scene", "solvers"}) {
        json report = good;
        report.erase(field);
        const std::string message =
            message_of<ArgumentError>([&] { report_html(report, ReportPictures()); });
        EXPECT_NE(message.find(field), std::string::npos) << message;
    }
    json nameless = good;
    nameless["solvers"][1].erase("name");
    EXPECT_THROW(report_html(nameless, {}), ArgumentError);
    EXPECT_THROW(report_html(json::array(), {}), ArgumentError);
    ReportPictures pictures;
    pictures.video = "/nonexistent_folder/a.mp4";
    const std::string message = message_of<LoadError>([&] { report_html(good, pictures); });
    EXPECT_NE(message.find(pictures.video), std::string::npos) << message;
}

}  // namespace
}  // namespace cloth::test
