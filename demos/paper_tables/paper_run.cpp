#include "demos/paper_tables/paper_run.h"

#include <filesystem>

#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/core/read_file.h"
#include "demos/paper_tables/figures.h"
#include "demos/paper_tables/garment_rows.h"
#include "demos/paper_tables/page.h"
#include "demos/paper_tables/training_rows.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

namespace cloth {

using nlohmann::ordered_json;

namespace {

/// The trainings of figure 7; an empty list if the committed report is not there.
ordered_json neighbours_of(const std::string& given) {
    std::string file = given;
    if (file.empty()) {
        file = asset_path("weights") + "/../figures/neighbours.json";
        if (!std::filesystem::exists(file)) return ordered_json::array();
    }
    const ordered_json report = ordered_json::parse(read_file(file), nullptr, false);
    const std::string remedy = "take the report of train_series --series neighbours";
    if (!report.is_object() || report.value("series", "") != "neighbours" ||
        !report.contains("rows") || !report.at("rows").is_array())
        throw LoadError(file, "", "is no report of trainings with 1 to 7 neighbours", remedy);
    for (const ordered_json& row : report.at("rows")) {
        const ordered_json name = row.is_object() ? row.value("name", ordered_json()) : row;
        if (!name.is_string() || name.get<std::string>().size() != 1 ||
            std::string("1234567").find(name.get<std::string>()) == std::string::npos)
            throw LoadError(file, "rows", "has a row without a name from 1 to 7", remedy);
    }
    return report.at("rows");
}

ordered_json provenance(const PaperOptions& options, int threads) {
    ordered_json json = provenance_json(threads);
    if (!options.note.empty()) json["note"] = options.note;
    return json;
}

/// Rows in the order in which tables show them, whatever was measured first.
void arrange_rows(const PaperOptions& options, PaperReport& report) {
    std::vector<ordered_json> places;
    for (const auto& plans : {paper_plan({}), paper_plan(options)})
        for (const GarmentPlan& plan : plans)
            for (const std::string& solver : plan.solvers)
                places.push_back({{"garment", plan.garment}, {"solver", solver}});
    report.arrange("rows", places);
}

void write_figures(const std::string& folder, const PaperReport& report) {
    const ordered_json& document = report.document();
    write_text_file(folder + "/paper_tables.md", paper_page(report.path(), document));
    write_text_file(folder + "/figure_6.csv", figure_6_csv(document));
    write_text_file(folder + "/figure_6.svg", figure_6_svg(document, "fast+0", "baseline+0"));
    write_text_file(folder + "/figure_7.svg", figure_7_svg(document));
}

}  // namespace

void run_paper_tables(const PaperOptions& options, int threads, const ProgressFunction& progress) {
    const std::vector<GarmentPlan> plan = paper_plan(options);
    for (const GarmentPlan& garment : plan)
        for (const std::string& solver : garment.solvers)
            what_is_missing(solver, garment.garment, options.weights);  // throws for unknown ones
    const ordered_json neighbours = neighbours_of(options.neighbours);
    PaperReport report(options.out, threads, options.again);
    report.set("provenance", provenance(options, threads));
    report.set("neighbours", neighbours);
    GarmentRowSettings rows;
    rows.solver = {options.weights, threads, nullptr};
    rows.references = options.references;
    for (const GarmentPlan& garment : plan) {
        measure_garment(garment, rows, report, progress);
        arrange_rows(options, report);
        write_figures(options.out, report);
    }
    if (!options.train.empty()) {
        const TrainingRowSettings training = {options.weights, options.train,
                                              options.training_iterations,
                                              options.out + "/trainings"};
        measure_trainings(paper_networks(), training, report, progress);
    }
    report.save();
    write_figures(options.out, report);
}

}  // namespace cloth
