#pragma once

#include "data/core/garment.h"

namespace cloth {

/// What static friction holds, see FrictionEnergy. Empty arrays: nothing yet.
struct StickMemory {
    Points slip;     ///< |V| x 3 (m): from where a vertex would be if it had stuck to its surface
    VectorX energy;  ///< |V| (J): that friction stores with it
};

/// What changes about a garment. A copy is a checkpoint for a new stepper: one that has taken other
/// steps since remembers those, such as which limbs the cloth passed through.
struct ClothState {
    Points x;           ///< positions (|V| x 3, m)
    Points v;           ///< velocities (|V| x 3, m/s): (x_t - x_{t-1}) / dt
    double time = 0.0;  ///< (s)
    /// Of the steps of a StepSolver. Who places cloth elsewhere may leave it, for it is worth a
    /// tenth of a millimetre, or clear it.
    StickMemory stick = {};

    /// The rest pose, not moving.
    static ClothState at_rest(const Garment& garment) {
        return {garment.rest().vertices, Points::Zero(garment.vertex_count(), 3), 0.0};
    }
};

}  // namespace cloth
