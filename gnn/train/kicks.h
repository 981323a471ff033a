#pragma once

#include "data/core/cloth_state.h"
#include "gnn/train/scene_random.h"

namespace cloth {

/// Perturbations of the state that a scene goes on from. States that a solver made teach nothing
/// about recovery from errors.
struct KickSettings {
    double share = 0.0;              ///< of the iterations that perturb their scene, 0 to 1
    double least_wavelength = 0.08;  ///< (m), 0.01 to 10
    double most_wavelength = 0.6;    ///< (m), least_wavelength to 10
    double slope = 0.35;             ///< of the wave of positions at most, 0 to 1
    double offset = 0.02;            ///< its amplitude at most (m), 0 to 0.1
    double speed = 0.7;              ///< amplitude of the wave of velocities at most (m/s), 0 to 10
    double noise_share = 1.0 / 3.0;  ///< of the kicks that add white noise too, 0 to 1
    double noise = 3e-3;             ///< its standard deviation at most (m), 0 to 0.02

    /// @throws ArgumentError if a value is out of its range
    void check() const;
};

/// x += a sin(k.x + f) u and v += b sin(l.x + g) w: plane waves of random length, direction, phase
/// and amplitude, along random unit vectors u and w. Then, in a share of the kicks, white noise on
/// x. Pinned vertices stay as they are.
void kick(const Garment& garment, const KickSettings& settings, SceneRandom& random,
          ClothState& state);

/// Adds independent normal noise to each coordinate (|V| x 3, m) of the vertices without pins.
void add_white_noise(const Garment& garment, double sigma, SceneRandom& random, Points& x);

}  // namespace cloth
