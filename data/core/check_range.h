#pragma once

#include <cstdio>
#include <string>

#include "data/core/errors.h"

namespace cloth {

/// @param field  such as "ContactProjectionSettings.growth"
/// @throws ArgumentError, naming the field, its value and the range, unless low <= value <= high;
///         NaN is never in a range
inline void check_range(const std::string& field, double value, double low, double high) {
    if (value >= low && value <= high) return;
    const auto text = [](double number) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.9g", number);
        return std::string(digits);
    };
    throw ArgumentError(field, text(value) + " is out of range",
                        "use " + text(low) + " to " + text(high));
}

}  // namespace cloth
