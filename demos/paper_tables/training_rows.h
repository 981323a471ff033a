#pragma once

#include <string>
#include <vector>

#include "demos/compare/references.h"
#include "demos/paper_tables/paper_report.h"

namespace cloth {

struct TrainingRowSettings {
    std::string weights;   ///< folder with NAME.csv; empty: the committed one
    std::string train;     ///< the program; empty: cost and memory are not measured
    int iterations = 120;  ///< of the longer of two short trainings, 40 to 100,000
    std::string work;      ///< folder for them, emptied
};

/// What a whole training has left in its metrics: {"iterations", "gap_tshirt", "gap_sheet" (of the
/// last validation), "history"}. History has [iteration, gap] for each row but the first four: the
/// mean over five rows of the median gap of the scenes that are trained on. Null: no such file.
/// @throws LoadError if the file is damaged
nlohmann::ordered_json training_history(const std::string& file);

/// Measures what the report has not: a row per network, and one named "smallest", of width 16 and
/// one step, for the memory that a training has without its network. A row has network, the
/// history's members, s_per_iteration (processor time) and peak_mb; null for what does not exist.
///
/// The cost is that of two short trainings on the same scenes, one a quarter as long as the other:
/// the difference of their processor times, over that of their iterations. So the time that a
/// program takes to start does not count, nor what else runs on the machine.
/// @throws LoadError naming the log if a training fails or is interrupted
void measure_trainings(const std::vector<std::string>& networks,
                       const TrainingRowSettings& settings, PaperReport& report,
                       const ProgressFunction& progress);

}  // namespace cloth
