#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace cloth {

/// JSON knows no NaN or infinity: they become null.
inline nlohmann::json json_number(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

/// Six digits, which is more than any measured figure is worth.
inline nlohmann::json rounded_number(double value) {
    if (value == 0.0 || !std::isfinite(value)) return json_number(value);
    const double scale = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
    return std::round(value * scale) / scale;
}

inline nlohmann::json json_numbers(const std::vector<double>& values) {
    nlohmann::json list = nlohmann::json::array();
    for (double value : values) list.push_back(json_number(value));
    return list;
}

}  // namespace cloth
