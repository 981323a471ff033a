#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/compare/references.h"
#include "demos/many_characters/options.h"

namespace cloth {

/// What one way of stepping a crowd takes.
struct CrowdRow {
    std::string solver;
    bool parallel = false;
    int characters = 0, vertices = 0;  ///< vertices of each garment
    int frames = 0;
    double ms_median = 0.0, ms_p95 = 0.0;  ///< of a world step
    double memory_mb = 0.0, another_mb = 0.0;
    double deepest_mm = 0.0;  ///< node inside a body
    long failed_steps = 0;
    bool same_bits = false;  ///< as the other way of stepping has it

    double characters_per_frame() const;  ///< that a frame of 1/30 s has time for
};

/// The crowd by one solver, its garments one after the other and at the same time, in turns.
/// @throws UsageError, LoadError naming what cannot be had
std::vector<CrowdRow> measure_crowd(const ManyCharactersOptions& options, const std::string& solver,
                                    const ProgressFunction& progress);

/// The row as a JSON object; null for what is not finite.
nlohmann::ordered_json to_json(const CrowdRow& row);

}  // namespace cloth
