#pragma once

#include <string>
#include <vector>

#include "demos/paper_tables/options.h"

namespace cloth {

/// What is measured on one garment.
struct GarmentPlan {
    std::string garment;
    int frames;  ///< of 1/30 s, all with references
    std::vector<std::string> solvers;
};

/// The networks of the paper, HOOD's and those of BSMS-GNN included.
const std::vector<std::string>& paper_networks();

/// The paper's garments with all solvers, and the one that has a skinning network; what the options
/// say instead of it.
std::vector<GarmentPlan> paper_plan(const PaperOptions& options);

/// A file that a solver needs and that is not there, in a sentence; empty: it has what it needs.
/// Only networks that the plan names may lack theirs.
/// @throws UsageError for any other solver that does not exist
std::string what_is_missing(const std::string& solver, const std::string& garment,
                            const std::string& weights);

/// The file of a solver's weights; empty: it has none.
std::string weights_of(const std::string& solver, const std::string& garment,
                       const std::string& weights);

}  // namespace cloth
