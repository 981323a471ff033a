#include "demos/paper_tables/garment_rows.h"

#include <algorithm>
#include <filesystem>

#include "demos/compare/input_files.h"
#include "demos/compare/json_numbers.h"
#include "demos/compare/statistics.h"
#include "demos/paper_tables/network_cost.h"
#include "demos/provenance/provenance.h"
#include "demos/speed_error/contest.h"
#include "demos/speed_error/reference_cache.h"
#include "demos/speed_error/scenes.h"
#include "demos/speed_error/solver_row.h"

namespace cloth {

using nlohmann::ordered_json;

namespace {

constexpr const char* fabric = "soft";

/// All that a row's figures depend on but the commit.
std::string key_of(const GarmentPlan& plan, const std::string& solver,
                   const GarmentRowSettings& settings) {
    if (!what_is_missing(solver, plan.garment, settings.solver.weights).empty()) return "missing";
    const std::string garment = files_key(garment_files(plan.garment));
    return std::to_string(plan.frames) + " frames, " + std::to_string(settings.solver.threads) +
           " threads, weights " +
           fingerprint(weights_of(solver, plan.garment, settings.solver.weights)) +
           (garment.empty() ? "" : ", garment " + garment);
}

ordered_json begun_row(const GarmentPlan& plan, const std::string& solver,
                       const GarmentRowSettings& settings) {
    return {{"garment", plan.garment}, {"solver", solver}, {"key", key_of(plan, solver, settings)}};
}

ordered_json rounded_terms(const EnergyTerms& terms) {
    ordered_json json;
    const nlohmann::json exact = to_json(terms);
    for (const char* term : {"strain", "bending", "contact", "gravity", "inertia", "friction"})
        json[term] = exact.at(term).is_null()
                         ? ordered_json()
                         : ordered_json(rounded_number(exact.at(term).get<double>()));
    return json;
}

ordered_json loss_json(const std::vector<EnergyTerms>& terms) {
    if (terms.empty()) return nullptr;
    const EnergyTerms mean = mean_terms(terms);
    ordered_json json = rounded_terms(mean);
    json["total"] = rounded_number(mean.total());
    return json;
}

Rollout roll_out_with_terms(const ComparisonScene& scene, const ClothState& start,
                            const References& references, Stepper& stepper,
                            const std::function<void(int)>& done) {
    Proximity proximity;
    StepEnergies energies(scene.garment());
    RolloutMeter meter(scene, references, start, stepper, proximity);
    while (meter.frame() < scene.frames()) {
        const auto frame = static_cast<size_t>(meter.frame());
        const Boundary boundary = scene.frame_boundary(meter.frame());
        if (!meter.advance(boundary)) break;
        meter.record_terms(energies, boundary, references.fine.at(frame + 1).x);
        done(meter.frame());
    }
    return meter.rollout();
}

ordered_json figures_json(const SolverRow& row, const std::vector<EnergyTerms>& terms) {
    ordered_json json;
    json["frames"] = row.frames;
    json["fps"] = rounded_number(1e3 / row.ms_median);
    json["ms_median"] = rounded_number(row.ms_median);
    json["ms_p95"] = rounded_number(row.ms_p95);
    json["memory_mb"] = rounded_number(row.peak_memory_mb);
    json["network_mb"] = json["network_ms"] = nullptr;
    json["loss"] = loss_json(terms);
    json["gap_median"] = rounded_number(row.gap_median);
    json["rollout_rmse_mm"] = rounded_number(row.rollout_rmse_mm);
    json["fine_rmse_mm"] = rounded_number(row.fine_rmse_mm);
    json["stretch_p99"] = rounded_number(row.stretch_p99);
    json["penetration_max_mm"] = rounded_number(row.penetration_max_mm);
    const bool failed = row.first_failed_frame.has_value();
    json["first_failed_frame"] = failed ? ordered_json(*row.first_failed_frame) : ordered_json();
    json["failure"] = failed ? ordered_json(row.failure) : ordered_json();
    return json;
}

/// A scene and what solvers are measured against in it.
struct MeasuredScene {
    const ComparisonScene& scene;
    ClothState start;
    References references;
};

ordered_json measure_solver(const MeasuredScene& measured, const std::string& solver,
                            const SolverSettings& settings, bool detailed,
                            const ProgressFunction& progress) {
    const ComparisonScene& scene = measured.scene;
    const auto make = [&] { return make_solver(solver, scene, settings); };
    std::vector<Contestant> one;
    one.push_back({solver, make_warm(scene, measured.start, make)});
    const Rollout rollout = roll_out_with_terms(
        scene, measured.start, measured.references, *one[0].warm.stepper,
        [&](int done) { progress(done, scene.frames(), solver + ", rollout"); });
    const std::vector<SingleSteps> single = make_single_steps(
        scene, measured.references, one, [&](int done, int all, const std::string&) {
            progress(done, all, solver + ", single steps");
        });
    SolverRow row = make_row(solver, {rollout, single[0]}, {});
    row.peak_memory_mb = one[0].warm.memory_mb;
    ordered_json json = figures_json(row, rollout.terms);
    if (detailed)
        for (const EnergyTerms& terms : rollout.terms)
            json["terms"].push_back(rounded_terms(terms));
    return json;
}

std::vector<std::string> not_measured(const GarmentPlan& plan, const GarmentRowSettings& settings,
                                      const PaperReport& report) {
    std::vector<std::string> left;
    for (const std::string& solver : plan.solvers) {
        const ordered_json row = begun_row(plan, solver, settings);
        if (!report.has("rows", row, row.at("key"))) left.push_back(solver);
    }
    return left;
}

bool is_network(const std::string& solver) {
    return solver_family(solver).kind == SolverFamily::Kind::network;
}

/// The rows of this garment's networks that have been measured.
std::vector<ordered_json> network_rows(const GarmentPlan& plan, const PaperReport& report) {
    std::vector<ordered_json> rows;
    if (!report.document().contains("rows")) return rows;
    for (const ordered_json& row : report.document().at("rows"))
        if (row.at("garment") == plan.garment && !row.contains("missing") &&
            is_network(row.at("solver").get<std::string>()))
            rows.push_back(row);
    return rows;
}

/// All networks of a garment are measured together, once their rows are there.
bool lacks_costs(const GarmentPlan& plan, const PaperReport& report) {
    const std::vector<ordered_json> rows = network_rows(plan, report);
    return std::any_of(rows.begin(), rows.end(),
                       [](const ordered_json& row) { return row.at("network_ms").is_null(); });
}

void put_costs(const GarmentPlan& plan, const MeasuredScene& measured,
               const GarmentRowSettings& settings, PaperReport& report) {
    std::vector<std::string> files;
    const auto index_of = [&](const std::string& file) {
        const auto at = std::find(files.begin(), files.end(), file);
        if (at != files.end()) return static_cast<size_t>(at - files.begin());
        files.push_back(file);
        return files.size() - 1;
    };
    std::vector<ordered_json> rows = network_rows(plan, report);
    std::vector<size_t> network;
    for (const ordered_json& row : rows)
        network.push_back(index_of(weights_of(row.at("solver").get<std::string>(), plan.garment,
                                              settings.solver.weights)));
    const std::vector<NetworkCost> costs =
        network_costs(files, measured.scene, measured.start, settings.solver.threads);
    for (size_t k = 0; k < rows.size(); ++k) {
        rows[k]["network_mb"] = rounded_number(costs[network[k]].memory_mb);
        rows[k]["network_ms"] = rounded_number(costs[network[k]].ms);
        report.put("rows", rows[k]);
    }
}

/// Rows of solvers that lack their weights; the others are returned.
std::vector<std::string> put_missing(const GarmentPlan& plan, const GarmentRowSettings& settings,
                                     const std::vector<std::string>& solvers, PaperReport& report) {
    std::vector<std::string> others;
    for (const std::string& solver : solvers) {
        const std::string missing = what_is_missing(solver, plan.garment, settings.solver.weights);
        if (missing.empty()) {
            others.push_back(solver);
            continue;
        }
        ordered_json row = begun_row(plan, solver, settings);
        row["missing"] = missing;
        report.put("rows", row);
    }
    return others;
}

}  // namespace

void measure_garment(const GarmentPlan& plan, const GarmentRowSettings& settings,
                     PaperReport& report, const ProgressFunction& progress) {
    const std::vector<std::string> left =
        put_missing(plan, settings, not_measured(plan, settings, report), report);
    if (left.empty() && !lacks_costs(plan, report)) return;
    const auto tell = [&](int done, int all, const std::string& what) {
        progress(done, all, plan.garment + ": " + what);
    };
    SceneSettings scene_settings;
    scene_settings.name = plan.garment;
    scene_settings.fabric = fabric;
    scene_settings.frames = plan.frames;
    const std::unique_ptr<ComparisonScene> scene = make_scene(scene_settings);
    // A name that cannot be used is known before the expensive part begins.
    for (const std::string& solver : left) make_solver(solver, *scene, settings.solver);
    const ReferenceCache cache(settings.references + "/" + build_commit(),
                               std::filesystem::path(plan.garment).stem().string() +
                                   short_key(garment_files(plan.garment)),
                               *scene);
    const ClothState start = cache.start(tell);
    const MeasuredScene measured{*scene, start, cache.references(start, tell)};
    for (size_t k = 0; k < left.size(); ++k) {
        const auto count = [&](int done, int all, const std::string& what) {
            tell(done, all,
                 what + " (" + std::to_string(k + 1) + " of " + std::to_string(left.size()) + ")");
        };
        const bool detailed = plan.garment == settings.detailed &&
                              std::count(settings.detailed_solvers.begin(),
                                         settings.detailed_solvers.end(), left[k]) > 0;
        ordered_json row = begun_row(plan, left[k], settings);
        row["vertices"] = scene->garment().vertex_count();
        row.update(measure_solver(measured, left[k], settings.solver, detailed, count));
        report.put("rows", row);
    }
    if (lacks_costs(plan, report)) put_costs(plan, measured, settings, report);
}

}  // namespace cloth
