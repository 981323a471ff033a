#pragma once

#include "collision/proximity/proximity.h"
#include "data/core/boundary.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// x_t + dt v_t (|V| x 3, m), which is 2 x_t - x_{t-1}: no gravity, no pins, no obstacles.
void linear_extrapolation(const ClothState& state, double dt, Points& x);

/// The linear extrapolation with every vertex that would end closer than `contact_distance` (m) to
/// the plane of its carried contact (point1, normal1) pushed out along the normal to that distance.
void projected_extrapolation(const ClothState& state, const SurfaceContacts& contacts, double dt,
                             double contact_distance, Points& x);

/// Puts the pinned rows of `x` on the boundary's targets (|pins| x 3, in the order of
/// garment.pins()).
void place_pins(const Garment& garment, const Boundary& boundary, Points& x);

/// Moves vertices that are farther from their goals at t + dt than the garment's limits allow, or
/// behind their backstops, to where they may be.
void move_to_goals(const Garment& garment, const Boundary& boundary, Points& x);

/// Where networks start: the extrapolation, moved to within the limits of goals, projected out of
/// obstacles, with the pins at their targets.
void starting_guess(const Garment& garment, const ClothState& state, const Boundary& boundary,
                    const SurfaceContacts& contacts, double dt, double contact_distance, Points& x);

/// Where solvers without a network start: the same, but vertices that were closer to an obstacle
/// than `contact_distance` at t are not lifted farther than where they were, up to 0.3 mm deep. So
/// contact carries from the start what it carried at t: cloth that rests or slides on a surface
/// would have to sink anew in every step, and would tremble where iterations are few.
void resting_guess(const Garment& garment, const ClothState& state, const Boundary& boundary,
                   const SurfaceContacts& contacts, double dt, double contact_distance, Points& x);

/// Whether one step can be made of these: arrays of the garment's sizes, all numbers finite, dt >
/// 0.
bool is_valid_step(const Garment& garment, const ClothState& state, const Boundary& boundary,
                   double dt);

}  // namespace cloth
