#include "demos/doc_tables/solver_tables.h"

#include <array>

#include "demos/doc_tables/solver_cells.h"

namespace cloth {

namespace {

/// To the fine solution, of a row of speed_error.json.
std::string distance_of(const DataRow& row) {
    return millimetres(row.number("/fine_rmse_mm")) +
           (row.is_null("/first_failed_frame") ? "" : " (fails)");
}

std::string median_and_p95(const DataRow& row) {
    return significant(row.number("/ms_median"), 2) + " / " + significant(row.number("/ms_p95"), 2);
}

/// Rows of speed_error.json with soft cotton.
DataRow soft_row(const DataFile& file, const std::string& scene, const std::string& solver) {
    return file.row("rows", {{"scene", scene}, {"fabric", "soft"}, {"solver", solver}});
}

constexpr std::array<const char*, 3> scenes = {"tshirt", "sphere", "sheet"};

}  // namespace

MarkdownTable whole_motion_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver",
                     "ms per frame",
                     "one step: gap",
                     "progress",
                     "RMSE (mm)",
                     "rollout: RMSE (mm)",
                     "to the fine solution (mm)",
                     "deepest point inside (mm)",
                     "failure"};
    for (const DataRow& row : files.at(0).rows("solvers"))
        table.rows.push_back({row.text("/name"), decimals(row.number("/ms_per_frame/median"), 1),
                              significant(row.number("/one_step/gap/median"), 3),
                              scientific(row.number("/one_step/progress/median")),
                              decimals(row.number("/one_step/rmse_mm"), 1),
                              decimals(row.number("/rollout/rmse_mm"), 0),
                              decimals(row.number("/rollout/fine_rmse_mm"), 0),
                              decimals(row.number("/rollout/penetration/max_mm"), 0),
                              failure_of(row)});
    return table;
}

MarkdownTable proxy_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver",
                     "to the fine solution (mm)",
                     "one step: gap",
                     "strain / bending energy (mJ)",
                     "RMSE (mm)",
                     "stretch: 99 %",
                     "longest edge",
                     "trembling (mm)",
                     "deepest point inside (mm)",
                     "failure"};
    for (const DataRow& row : files.at(0).rows("solvers"))
        table.rows.push_back(
            {row.text("/name"), decimals(row.number("/rollout/fine_rmse_mm"), 1),
             significant(row.number("/one_step/gap/median"), 2),
             decimals(1e3 * row.number("/one_step/energy_terms/strain"), 1) + " / " +
                 decimals(1e3 * row.number("/one_step/energy_terms/bending"), 2),
             decimals(row.number("/one_step/rmse_mm"), 1),
             decimals(row.number("/rollout/stretch/p99"), 3),
             decimals(row.number("/rollout/stretch/max"), 2),
             decimals(row.number("/rollout/jitter_mm"), 2),
             decimals(row.number("/rollout/penetration/max_mm"), 1), failure_of(row)});
    return table;
}

MarkdownTable detail_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver"};
    for (const char* scene : {"T-shirt", "sheet on a sphere", "hanging sheet"}) {
        table.heading.push_back(std::string(scene) + ": ms per step, median / 95 %");
        for (const char* figure : {"mm", "gap", "stretch"}) table.heading.push_back(figure);
    }
    for (const DataRow& first : files.at(0).rows("rows")) {
        if (first.text("/scene") != scenes[0]) continue;
        table.rows.push_back({first.text("/solver")});
        for (const char* scene : scenes) {
            const DataRow row = soft_row(files.at(0), scene, first.text("/solver"));
            for (const std::string& cell :
                 {median_and_p95(row), distance_of(row), significant(row.number("/gap_median"), 2),
                  decimals(row.number("/stretch_p99"), 3)})
                table.rows.back().push_back(cell);
        }
    }
    return table;
}

MarkdownTable speed_error_table(const std::vector<DataFile>& files) {
    static const char* const solvers[] = {"bullet-10x2",
                                          "bullet-10x8",
                                          "xpbd-20",
                                          "xpbd-40",
                                          "xpbd-100",
                                          "quasi-newton-1",
                                          "quasi-newton-3",
                                          "quasi-newton-10",
                                          "quasi-newton",
                                          "quasi-newton-30",
                                          "quasi-newton-3-bdf2",
                                          "quasi-newton-10-bdf2",
                                          "quasi-newton-bdf2",
                                          "newton-3",
                                          "reference",
                                          "small+0",
                                          "small+3",
                                          "small+10",
                                          "small",
                                          "small+10-bdf2",
                                          "medium+0",
                                          "medium+3",
                                          "medium+10",
                                          "fast+0",
                                          "fast+3",
                                          "fast+10",
                                          "fast",
                                          "fast+10-bdf2",
                                          "reduction+10",
                                          "sampling+10",
                                          "baseline+0",
                                          "baseline+10"};
    MarkdownTable table;
    table.heading = {"solver", "T-shirt: time",       "gap", "mm", "sphere: time", "gap",
                     "mm",     "hanging sheet: time", "gap", "mm"};
    for (const char* solver : solvers) {
        std::vector<std::string> cells = {solver};
        for (const char* scene : scenes) {
            const DataRow row = soft_row(files.at(0), scene, solver);
            cells.push_back(significant(row.number("/ms_ratio"), 2));
            cells.push_back(significant(row.number("/gap_median"), 2));
            cells.push_back(distance_of(row));
        }
        table.rows.push_back(cells);
    }
    return table;
}

MarkdownTable which_solver_table(const std::vector<DataFile>& files) {
    static const std::pair<const char*, const char*> choices[] = {
        {"xpbd-40", "a body carries the cloth, and nothing else fits into the time"},
        {"quasi-newton-3s120",
         "in general: the default of soft cloth. 120 small steps a second, with three iterations "
         "each"},
        {"quasi-newton-2s120",
         "time is short, and XPBD lacks what you need: limbs, `maxMs`, reactions through anchors"},
        {"default~1000+1",
         "a fine garment has to be cheap: a coarse one is simulated, which carries it, and one "
         "iteration of its own takes away the stretch of the coarse shape (`make_proxy_cloth()`)"},
        {"small+3~1000",
         "the least time for a fine garment: a network and three iterations step the coarse one"},
        {"small60+2s60~1500",
         "a fine garment on a character: in each 60th of a second a network and two iterations "
         "step the coarse one (`ProxyClothSettings::learned()`)"},
        {"quasi-newton",
         "each step should be solved well: whole steps, iterations for as long as they gain"}};
    MarkdownTable table;
    table.heading = {"solver",
                     "use it when",
                     "T-shirt: ms per step, median / 95 %",
                     "distance (mm)",
                     "sheet on a sphere: ms",
                     "mm",
                     "hanging sheet: ms",
                     "mm"};
    for (const auto& [solver, when] : choices) {
        std::vector<std::string> cells = {solver, when};
        for (const char* scene : scenes) {
            const DataRow row = soft_row(files.at(0), scene, solver);
            cells.insert(cells.end(), {median_and_p95(row), distance_of(row)});
        }
        table.rows.push_back(cells);
    }
    return table;
}

namespace {

/// All solvers of a report on all scenes.
MarkdownTable scenes_table(const DataFile& file, const std::string& fabric) {
    MarkdownTable table;
    table.heading = {"solver",
                     "T-shirt: ms per step, median / 95 %",
                     "distance (mm)",
                     "sheet on a sphere: ms",
                     "mm",
                     "hanging sheet: ms",
                     "mm"};
    for (const DataRow& first : file.rows("rows")) {
        if (first.text("/scene") != scenes[0]) continue;
        std::vector<std::string> cells = {first.text("/solver")};
        for (const char* scene : scenes) {
            const DataRow row =
                file.row("rows", {{"scene", scene}, {"fabric", fabric}, {"solver", cells[0]}});
            cells.insert(cells.end(), {median_and_p95(row), distance_of(row)});
        }
        table.rows.push_back(cells);
    }
    return table;
}

}  // namespace

MarkdownTable small_steps_table(const std::vector<DataFile>& files) {
    return scenes_table(files.at(0), "soft");
}

MarkdownTable stiff_table(const std::vector<DataFile>& files) {
    return scenes_table(files.at(0), "real");
}

MarkdownTable real_time_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver"};
    for (const DataFile& file : files) {
        const std::string vertices = decimals(file.rows("scenes").at(0).number("/vertices"), 0);
        table.heading.push_back(vertices + " vertices: ms per step, median / 95 % / longest");
        table.heading.push_back("mm");
    }
    for (const DataRow& first : files.at(0).rows("rows")) {
        const std::string solver = first.text("/solver");
        std::vector<std::string> cells = {solver};
        for (const DataFile& file : files) {
            const DataRow row = file.row("rows", {{"solver", solver}});
            cells.push_back(median_and_p95(row) + " / " +
                            significant(row.number("/ms_longest"), 2));
            cells.push_back(distance_of(row));
        }
        table.rows.push_back(cells);
    }
    return table;
}

MarkdownTable learned_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver"};
    for (size_t k = 0; k < files.size(); ++k) {
        const double vertices = files[k].rows("scenes").at(0).number("/vertices");
        table.heading.push_back(std::string(garments_over_proxies.at(k)) + " of " +
                                decimals(vertices, 0) + " vertices: ms per step, median / 95 %");
        for (const char* figure : {"ratio", "mm", "gap", "stretch"})
            table.heading.push_back(figure);
    }
    for (const DataRow& first : files.at(0).rows("rows")) {
        table.rows.push_back({first.text("/solver")});
        for (const DataFile& file : files) {
            const DataRow row = file.row("rows", {{"solver", first.text("/solver")}});
            for (const std::string& cell :
                 {median_and_p95(row), significant(row.number("/ms_ratio"), 2), distance_of(row),
                  significant(row.number("/gap_median"), 2),
                  decimals(row.number("/stretch_p99"), 3)})
                table.rows.back().push_back(cell);
        }
    }
    return table;
}

MarkdownTable bfloat16_rollout_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver", "one step: gap", "rollout: RMSE (mm)"};
    for (const DataRow& row : files.at(0).rows("solvers"))
        table.rows.push_back({row.text("/name"), significant(row.number("/one_step/gap/median"), 3),
                              decimals(row.number("/rollout/rmse_mm"), 1)});
    return table;
}

}  // namespace cloth
