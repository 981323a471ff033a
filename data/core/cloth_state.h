#pragma once

#include "data/core/garment.h"

namespace cloth {

/// Everything about a garment that changes. A copy is a checkpoint.
struct ClothState {
    Points x;           ///< positions (|V| x 3, m)
    Points v;           ///< velocities (|V| x 3, m/s): (x_t - x_{t-1}) / dt
    double time = 0.0;  ///< (s)

    /// The rest pose, not moving.
    static ClothState at_rest(const Garment& garment) {
        return {garment.rest().vertices, Points::Zero(garment.vertex_count(), 3), 0.0};
    }
};

}  // namespace cloth
