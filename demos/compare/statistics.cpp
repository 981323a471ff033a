#include "demos/compare/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cloth {

double quantile(std::vector<double> values, double part) {
    values.erase(std::remove_if(values.begin(), values.end(),
                                [](double value) { return std::isnan(value); }),
                 values.end());
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::sort(values.begin(), values.end());
    const double position = part * static_cast<double>(values.size() - 1);
    const size_t low = static_cast<size_t>(position);
    const size_t high = std::min(low + 1, values.size() - 1);
    const double weight = position - static_cast<double>(low);
    // two infinite neighbours must not make NaN
    return weight == 0.0 ? values[low] : (1.0 - weight) * values[low] + weight * values[high];
}

double median(const std::vector<double>& values) {
    return quantile(values, 0.5);
}

double mean(const std::vector<double>& values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double mean_of_known(const std::vector<double>& values) {
    std::vector<double> known;
    for (double value : values)
        if (!std::isnan(value)) known.push_back(value);
    return mean(known);
}

}  // namespace cloth
