#pragma once

#include <algorithm>

namespace cloth {

/// 0 to 1 with zero velocity and acceleration at both ends; s is clamped to [0, 1].
inline double ease(double s) {
    s = std::clamp(s, 0.0, 1.0);
    return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

}  // namespace cloth
