#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/train_series/training_series.h"

namespace cloth {

struct SeriesSettings {
    std::string train;              ///< the program
    std::string trainings;          ///< folder of the trainings: kept, so that a series can go on
    int iterations = 0;             ///< 0: the series' own; 1 to 10,000,000
    std::vector<std::string> only;  ///< names of trainings; empty: all
    std::vector<int> seeds = {1, 2};
    std::vector<std::string> arguments;  ///< of `train`, after all others
};

/// Trains what is not trained yet, one after another.
/// @param say  told how far it is, a line at a time
/// @return  the report: {"provenance", "series", "iterations", "rows"}; a row has name, meaning,
///          arguments, seed, provenance, processor_s, peak_mb (null where the training was
///          interrupted) and the last row of metrics.csv
/// @throws LoadError naming the log if a training fails, or was interrupted; ArgumentError for a
///         name that is not in the series
nlohmann::ordered_json run_series(const TrainingSeries& series, const SeriesSettings& settings,
                                  const std::function<void(const std::string&)>& say);

}  // namespace cloth
