#pragma once

#include <vector>

namespace cloth {

/// Value below which the given part (0 to 1) of the values lies; NaN if there are none.
double quantile(std::vector<double> values, double part);

double median(const std::vector<double>& values);
double mean(const std::vector<double>& values);  ///< NaN if there are none
/// Mean of those that are not NaN.
double mean_of_known(const std::vector<double>& values);

}  // namespace cloth
