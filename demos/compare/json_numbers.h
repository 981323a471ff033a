#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace cloth {

/// JSON knows no NaN or infinity: they become null.
inline nlohmann::json json_number(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

inline nlohmann::json json_numbers(const std::vector<double>& values) {
    nlohmann::json list = nlohmann::json::array();
    for (double value : values) list.push_back(json_number(value));
    return list;
}

}  // namespace cloth
