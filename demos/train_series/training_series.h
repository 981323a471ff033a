#pragma once

#include <string>
#include <vector>

namespace cloth {

/// One training of a series: how it differs from the others.
struct SeriesTraining {
    std::string name;                    ///< of the row, unique
    std::string meaning;                 ///< in words
    std::vector<std::string> arguments;  ///< of `train`, after those of the series
};

/// Trainings of equal length that differ in one thing, so that it can be seen what it buys.
struct TrainingSeries {
    std::string name, sentence;
    std::vector<std::string> arguments;  ///< of `train`, for all
    int iterations;
    std::vector<SeriesTraining> trainings;
};

/// `states`: what a network is trained on. `variants`: the paper's four networks. `neighbours`: 1
/// to 7 sampled neighbours.
const std::vector<TrainingSeries>& training_series();

/// @throws ArgumentError naming the series there are
const TrainingSeries& training_series(const std::string& name);

}  // namespace cloth
