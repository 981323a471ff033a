#include "demos/doc_tables/paper_tables.h"

#include <array>

#include "demos/doc_tables/paper_data.h"
#include "demos/doc_tables/paper_figures.h"
#include "demos/doc_tables/solver_cells.h"

namespace cloth {
namespace {

constexpr std::array<const char*, 6> energy_terms = {"strain",  "bending", "contact",
                                                     "gravity", "inertia", "friction"};

/// The network of "fast+0", if the solver is a network alone, as the paper has it.
std::string network_alone(const std::string& solver) {
    const std::string end = "+0";
    if (solver.size() <= end.size() || solver.substr(solver.size() - end.size()) != end) return "";
    return solver.substr(0, solver.size() - end.size());
}

std::vector<std::string> garment_cells(const PaperData& data, const std::string& garment,
                                       const std::string& solver) {
    const auto paper = paper_inference(network_alone(solver), garment);
    std::vector<std::string> cells = {solver, paper ? significant(paper->fps, 3) : "–"};
    const std::optional<DataRow> row = data.row(garment, solver);
    const auto number = [&](const std::string& pointer) {
        return data.number(garment, solver, pointer);
    };
    cells.push_back(significant(number("/fps"), 3));
    cells.push_back(significant(1e3 / number("/network_ms"), 3));
    cells.push_back(paper ? decimals(paper->memory_mb, 0) : "–");
    cells.push_back(significant(number("/memory_mb"), 2));
    cells.push_back(significant(number("/network_mb"), 2));
    cells.push_back(paper ? significant(paper->loss, 3) : "–");
    cells.push_back(significant(number("/loss/total"), 3));
    cells.push_back(significant(number("/gap_median"), 2));
    cells.push_back(millimetres(number("/fine_rmse_mm")));
    cells.push_back(row ? failure_of(*row) : data.missing(garment, solver));
    return cells;
}

}  // namespace

MarkdownTable paper_training_table(const std::vector<DataFile>& files) {
    const PaperData data(files.at(0));
    const double gap = data.common_gap();
    MarkdownTable table;
    table.heading = {"network",
                     "paper: training (h)",
                     "ours (h of processor)",
                     "ours, to a gap of " + significant(gap, 3) + " (h)",
                     "iterations to it",
                     "paper: s per iteration",
                     "ours",
                     "paper: memory (GB)",
                     "ours (MB)",
                     "gap at the end: T-shirt",
                     "sheets"};
    for (const std::string& network : data.trained_networks()) {
        const PaperTraining paper = paper_training(network).value_or(PaperTraining{});
        const double cost = data.training(network, "/s_per_iteration");
        const double iterations = data.training(network, "/iterations");
        const double to_gap = data.iterations_to(network, gap);
        table.rows.push_back(
            {network, decimals(paper.hours, 0), significant(cost * iterations / 3600.0, 2),
             significant(cost * to_gap / 3600.0, 2), decimals(to_gap, 0),
             significant(paper.s_per_iteration, 3), significant(cost, 2),
             significant(paper.memory_gb, 3), decimals(data.training(network, "/peak_mb"), 0),
             significant(data.training(network, "/gap_tshirt"), 2),
             significant(data.training(network, "/gap_sheet"), 2)});
    }
    return table;
}

MarkdownTable paper_garment_table(const std::vector<DataFile>& files, const std::string& garment) {
    const PaperData data(files.at(0));
    MarkdownTable table;
    table.heading = {"solver",
                     "paper: frames per second",
                     "ours",
                     "of the network alone",
                     "paper: memory (MB)",
                     "ours (MB)",
                     "of it the network",
                     "paper: loss",
                     "ours (J)",
                     "energy gap",
                     "to the fine solution (mm)",
                     "failure"};
    for (const std::string& solver : data.solvers(garment))
        table.rows.push_back(garment_cells(data, garment, solver));
    return table;
}

MarkdownTable paper_hood_table(const std::vector<DataFile>& files) {
    const PaperData data(files.at(0));
    const PaperInference hood = *paper_inference("hood", ""),
                         fast = *paper_inference("hood_fast", "");
    MarkdownTable table;
    table.heading = {"HOOD + ours over HOOD",
                     "speed",
                     "of the network",
                     "memory",
                     "of the network",
                     "loss",
                     "gap",
                     "to the fine solution"};
    table.rows.push_back({"paper", significant(fast.fps / hood.fps, 3), "–",
                          significant(fast.memory_mb / hood.memory_mb, 2), "–",
                          significant(fast.loss / hood.loss, 3), "–", "–"});
    for (const char* garment : paper_garments)
        for (const char* form : {"+0", "+3"}) {
            const auto ratio = [&](const std::string& pointer) {
                return data.number(garment, std::string("hood_fast") + form, pointer) /
                       data.number(garment, std::string("hood") + form, pointer);
            };
            table.rows.push_back(
                {std::string(garment) + ", " + form, significant(ratio("/fps"), 3),
                 significant(1.0 / ratio("/network_ms"), 3), significant(ratio("/memory_mb"), 2),
                 significant(ratio("/network_mb"), 2), significant(ratio("/loss/total"), 3),
                 significant(ratio("/gap_median"), 2), significant(ratio("/fine_rmse_mm"), 2)});
        }
    return table;
}

MarkdownTable paper_terms_table(const std::vector<DataFile>& files) {
    const PaperData data(files.at(0));
    MarkdownTable table;
    table.heading = {"T-shirt"};
    for (const char* term : energy_terms) table.heading.push_back(std::string(term) + " (J)");
    table.heading.emplace_back("total (J)");
    for (const char* solver : {"baseline+0", "fast+0", "baseline+3", "fast+3", "reference"}) {
        std::vector<std::string> cells = {solver};
        for (const char* term : energy_terms)
            cells.push_back(
                significant(data.number("tshirt", solver, std::string("/loss/") + term), 3));
        cells.push_back(significant(data.number("tshirt", solver, "/loss/total"), 3));
        table.rows.push_back(cells);
    }
    return table;
}

MarkdownTable paper_neighbours_table(const std::vector<DataFile>& files) {
    const PaperData data(files.at(0));
    MarkdownTable table;
    table.heading = {"sampled neighbours",     "trainings",
                     "gap: T-shirt",           "sheets",
                     "scenes trained on",      "rollout alone (mm)",
                     "with 3 iterations (mm)", "processor time of a training (s)"};
    for (int count = 1; count <= 7; ++count) {
        const auto mean = [&](const char* column) { return data.neighbours(count, column); };
        table.rows.push_back(
            {std::to_string(count), std::to_string(data.neighbour_seeds(count)),
             significant(mean("gap_tshirt_median"), 3), significant(mean("gap_sheet_median"), 3),
             significant(mean("gap_training_median"), 3), millimetres(mean("garment_rollout_0_mm")),
             millimetres(mean("garment_rollout_3_mm")), decimals(mean("processor_s"), 0)});
    }
    return table;
}

}  // namespace cloth
