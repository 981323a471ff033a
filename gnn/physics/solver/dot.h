#pragma once

#include "data/core/types.h"

namespace cloth {

/// Of two (|V| x 3) arrays, as vectors of 3 |V| components.
inline double dot(const Points& a, const Points& b) {
    return a.cwiseProduct(b).sum();
}

}  // namespace cloth
