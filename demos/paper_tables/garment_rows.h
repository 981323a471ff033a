#pragma once

#include "demos/compare/references.h"
#include "demos/compare/solver_factory.h"
#include "demos/paper_tables/paper_report.h"
#include "demos/paper_tables/plan.h"

namespace cloth {

struct GarmentRowSettings {
    SolverSettings solver;
    std::string references;  ///< folder that keeps them
    /// Solvers whose energies by term are kept frame by frame, if the garment is `detailed`.
    std::vector<std::string> detailed_solvers = {"baseline+0", "fast+0", "baseline+3", "fast+3",
                                                 "reference"};
    std::string detailed = "tshirt";
};

/// Measures what the report has not, solver by solver, each by itself: nothing else is alive while
/// its memory is taken. The garment is on the default body, in motion 01_01.
///
/// A row has garment, vertices, solver, frames, fps (1000 / median ms of a frame of the rollout),
/// ms_median, ms_p95, memory_mb (see make_warm()), network_mb and network_ms (see network_costs(),
/// null without network), loss (means over the frames of the rollout, J, by term and in total;
/// gravity counts from the fine solution), gap_median (single steps), rollout_rmse_mm,
/// fine_rmse_mm, stretch_p99, penetration_max_mm, failure and first_failed_frame. A solver without
/// weights has "missing" instead.
/// @throws UsageError for a solver that does not exist, before anything is measured
void measure_garment(const GarmentPlan& plan, const GarmentRowSettings& settings,
                     PaperReport& report, const ProgressFunction& progress);

}  // namespace cloth
