#pragma once

#include <string>

#include "data/core/errors.h"

namespace cloth {

/// @param field  such as "ContactProjectionSettings.growth"
/// @throws ArgumentError, naming the field, unless low <= value <= high
inline void check_range(const std::string& field, double value, double low, double high) {
    if (!(value >= low && value <= high))
        throw ArgumentError(field, std::to_string(value) + " is out of range",
                            "use " + std::to_string(low) + " to " + std::to_string(high));
}

}  // namespace cloth
