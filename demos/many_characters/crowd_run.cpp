#include "demos/many_characters/crowd_run.h"

#include <malloc.h>

#include <algorithm>

#include "demos/compare/json_numbers.h"
#include "demos/compare/memory.h"
#include "demos/compare/statistics.h"
#include "demos/many_characters/crowd.h"

namespace cloth {
namespace {

constexpr int first_steps = 2;  // frames until all is built

double trimmed_memory_mb() {
    malloc_trim(0);
    return resident_memory_mb();
}

/// A crowd after its first steps, and the memory that it took.
struct BegunCrowd {
    std::unique_ptr<Crowd> crowd;
    double memory_mb = 0.0;
};

BegunCrowd begin(const std::shared_ptr<const Body>& body, const std::vector<Motion>& motions,
                 const CrowdSettings& settings) {
    const double before = trimmed_memory_mb();
    BegunCrowd begun;
    begun.crowd = std::make_unique<Crowd>(body, motions, settings);
    for (int k = 0; k < first_steps; ++k) begun.crowd->step();
    begun.memory_mb = trimmed_memory_mb() - before;
    return begun;
}

bool have_same_nodes(const Crowd& a, const Crowd& b, int characters) {
    for (int k = 0; k < characters; ++k)
        if (a.nodes(k) != b.nodes(k)) return false;
    return true;
}

}  // namespace

double CrowdRow::characters_per_frame() const {
    return characters * 1e3 * Crowd::frame_time / ms_median;
}

std::vector<CrowdRow> measure_crowd(const ManyCharactersOptions& options, const std::string& solver,
                                    const ProgressFunction& progress) {
    const auto body = std::make_shared<const Body>(Body::load_default());
    std::vector<Motion> motions;
    for (const std::string& name : options.motions.empty() ? crowd_motions() : options.motions)
        motions.push_back(load_motion_by_name(name));
    const int count = options.characters;
    CrowdSettings settings = {1, options.garment, solver, true};
    begin(body, motions, settings);  // libraries and caches are no character's
    const double alone_mb = begin(body, motions, settings).memory_mb;

    settings.characters = count;
    std::vector<BegunCrowd> crowds;
    for (const bool parallel : {false, true}) {
        settings.parallel = parallel;
        crowds.push_back(begin(body, motions, settings));
    }
    std::vector<CrowdRow> rows(2);
    std::vector<std::vector<double>> ms(2);
    const int all = options.warm_up + options.frames;
    for (int frame = first_steps; frame < all; ++frame) {
        for (size_t k = 0; k < 2; ++k) {
            const double time = crowds[k].crowd->step();
            if (frame >= options.warm_up) ms[k].push_back(time);
            rows[k].deepest_mm = std::max(rows[k].deepest_mm,
                                          1e3 * crowds[k].crowd->solver().status().maxPenetration);
        }
        progress(frame + 1, all, solver + ": " + std::to_string(count) + " characters");
    }
    const bool same = have_same_nodes(*crowds[0].crowd, *crowds[1].crowd, count);
    for (size_t k = 0; k < 2; ++k) {
        rows[k].solver = solver;
        rows[k].parallel = k == 1;
        rows[k].characters = count;
        rows[k].vertices = static_cast<int>(crowds[k].crowd->nodes(0).rows());
        rows[k].frames = static_cast<int>(ms[k].size());
        rows[k].ms_median = median(ms[k]);
        rows[k].ms_p95 = quantile(ms[k], 0.95);
        rows[k].memory_mb = crowds[k].memory_mb / count;
        rows[k].another_mb = (crowds[k].memory_mb - alone_mb) / (count - 1);
        rows[k].failed_steps = crowds[k].crowd->solver().status().failedSteps;
        rows[k].same_bits = same;
    }
    return rows;
}

nlohmann::ordered_json to_json(const CrowdRow& row) {
    nlohmann::ordered_json json;
    json["solver"] = row.solver;
    json["stepping"] = row.parallel ? "at the same time" : "one after the other";
    json["characters"] = row.characters;
    json["vertices"] = row.vertices;
    json["frames"] = row.frames;
    json["ms_median"] = rounded_number(row.ms_median);
    json["ms_p95"] = rounded_number(row.ms_p95);
    json["characters_per_frame"] = rounded_number(row.characters_per_frame());
    json["memory_mb"] = rounded_number(row.memory_mb);
    json["another_mb"] = rounded_number(row.another_mb);
    json["deepest_mm"] = rounded_number(row.deepest_mm);
    json["failed_steps"] = row.failed_steps;
    json["same_bits"] = row.same_bits;
    return json;
}

}  // namespace cloth
