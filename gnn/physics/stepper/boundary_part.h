#pragma once

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// Cuts a step's boundary into equal parts in time. Obstacles, primitive frames, goals and
/// pins move evenly from where they are at t to where the boundary says they are at t + dt; parts
/// join, and the last one ends where the step ends, bit for bit.
///
///     BoundaryPart part;
///     part.begin(garment, state, boundary, 4);
///     for (int k = 0; k < 4; ++k) { ... part.take(k) ... }
class BoundaryPart {
 public:
    /// Of obstacles: all, or no surfaces, for whom contacts are enough.
    enum class Surfaces { moved, left_out };

    /// Keeps a reference to `boundary` until the last part is taken.
    /// @param state  at t: where the pins are
    void begin(const Garment& garment, const ClothState& state, const Boundary& boundary, int count,
               Surfaces surfaces = Surfaces::moved);

    /// Part k, 0 to count - 1; valid until the next call.
    const Boundary& take(int k);

 private:
    const Boundary* m_whole = nullptr;
    int m_count = 1;
    Surfaces m_surfaces = Surfaces::moved;
    bool m_has_goals = false;
    Boundary m_part;
    Points m_pins_before;  ///< |pins| x 3 (m)
};

}  // namespace cloth
