#pragma once

#include "data/core/cloth_state.h"

namespace cloth {

/// A wind that blows level, with gusts.
struct WindSettings {
    double speed = 0.0;      ///< mean (m/s), 0 to 20; 0: no air at all
    double direction = 0.0;  ///< where it blows to (degrees): 0 along z, 90 along x; -360 to 360
    double gusts = 0.5;      ///< how far the speed swings about its mean, as a part of it, 0 to 1
};

bool operator==(const WindSettings& a, const WindSettings& b);

/// @throws ArgumentError naming the field that is out of range
void check(const WindSettings& settings);

/// Velocity of the air (m/s) at a time (s); the same for equal times.
Vec3 wind_velocity(const WindSettings& settings, double time);

/// What the air does to each vertex (|V| x 3, m/s^2), as Boundary::accelerations has it; empty
/// without wind. Each face is a flat plate that air of 1.2 kg/m^3 pushes along its normal n:
///
///     m du/dt = -k |u| u,   u = (v - wind) . n,   k = 1.2 kg/m^3 A / 2
///
/// of which the mean over a step of backward Euler is taken, u1 = u / (1 + k |u| dt / m): light
/// cloth is never blown faster than the air.
Points wind_accelerations(const WindSettings& settings, const Garment& garment,
                          const ClothState& state, double dt);

}  // namespace cloth
