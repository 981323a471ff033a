#include "demos/paper_tables/plan.h"

#include <algorithm>
#include <filesystem>

#include "data/core/paths.h"
#include "demos/speed_error/solver_family.h"

namespace cloth {
namespace {

constexpr int usual_frames = 30, dress_frames = 12;

/// Of the project, beside the paper's.
const std::vector<std::string> own_networks = {"small", "medium_own"};

std::vector<std::string> all_solvers() {
    std::vector<std::string> solvers = {"bullet",         "bullet-fine",     "xpbd-40",
                                        "quasi-newton-3", "quasi-newton-10", "quasi-newton",
                                        "reference"};
    for (const auto& names : {paper_networks(), own_networks})
        for (const std::string& name : names)
            for (const char* iterations : {"+0", "+3"}) solvers.push_back(name + iterations);
    return solvers;
}

std::string folder_of(const std::string& weights) {
    return weights.empty() ? asset_path("weights") : weights;
}

bool is_planned(const std::string& network) {
    return std::count(paper_networks().begin(), paper_networks().end(), network) +
               std::count(own_networks.begin(), own_networks.end(), network) >
           0;
}

}  // namespace

const std::vector<std::string>& paper_networks() {
    static const std::vector<std::string> names = {"baseline", "sampling",  "reduction", "fast",
                                                   "hood",     "hood_fast", "bistride"};
    return names;
}

std::vector<GarmentPlan> paper_plan(const PaperOptions& options) {
    std::vector<GarmentPlan> plan = {{"tshirt", usual_frames, all_solvers()},
                                     {"pants", usual_frames, all_solvers()},
                                     {"dress", dress_frames, all_solvers()},
                                     {"tshirt_1000",
                                      usual_frames,
                                      {"skinning", "skinning-raw", "fast+0", "fast+3", "small+0",
                                       "small+3", "xpbd-40", "quasi-newton", "reference"}}};
    if (!options.garments.empty()) {
        std::vector<GarmentPlan> chosen;
        for (const std::string& garment : options.garments) {
            const auto known = std::find_if(plan.begin(), plan.end(), [&](const GarmentPlan& one) {
                return one.garment == garment;
            });
            chosen.push_back(
                known != plan.end() ? *known : GarmentPlan{garment, usual_frames, all_solvers()});
        }
        plan = chosen;
    }
    for (GarmentPlan& one : plan) {
        if (options.frames > 0) one.frames = options.frames;
        if (!options.solvers.empty()) one.solvers = options.solvers;
    }
    return plan;
}

std::string weights_of(const std::string& solver, const std::string& garment,
                       const std::string& weights) {
    const SolverFamily family = solver_family(solver);
    if (family.kind == SolverFamily::Kind::skinning)
        return folder_of(weights) + "/skinning/" + garment + ".safetensors";
    if (family.kind != SolverFamily::Kind::network) return "";
    const std::string network = NetworkName(solver).variant;
    const std::string file = folder_of(weights) + "/" + network + ".safetensors";
    return is_planned(network) ? file : weights_file(network, weights);
}

std::string what_is_missing(const std::string& solver, const std::string& garment,
                            const std::string& weights) {
    const std::string file = weights_of(solver, garment, weights);
    if (file.empty() || std::filesystem::exists(file)) return "";
    return "not trained yet: no " + std::filesystem::path(file).filename().string();
}

}  // namespace cloth
