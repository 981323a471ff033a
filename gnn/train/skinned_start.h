#pragma once

#include "data/body/animated_body.h"
#include "data/core/cloth_state.h"
#include "gnn/train/scene_random.h"

namespace cloth {

/// Scenes that start with the garment posed like the skin under it, at any time of a motion: states
/// that no simulation has to reach first, and that are no solution of anything.
struct SkinnedStartSettings {
    double share = 0.0;    ///< of the scenes with a body, 0 to 1
    double at_rest = 0.5;  ///< of these start with a garment that does not move, 0 to 1; the others
                           ///< with one that moves like the skin
    double noise = 3e-3;   ///< of the start (m), 0 to 0.02

    /// @throws ArgumentError if a value is out of its range
    void check() const;
};

/// The garment posed with the body at a time (s), with noise, and pushed out of the body.
/// @param worn  on the body's rest pose (|V| x 3, m)
/// @param dt    of the velocity (s)
ClothState skinned_start(const Garment& garment, const Points& worn, const AnimatedBody& body,
                         const SkinnedStartSettings& settings, double time, double dt,
                         SceneRandom& random);

}  // namespace cloth
