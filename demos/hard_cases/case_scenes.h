#pragma once

#include "demos/hard_cases/hard_scene.h"
#include "demos/hard_cases/props.h"

/// One function per hard case: garment, start and the outside over time.
namespace cloth {

// contact: contact_scenes.cpp, body_scenes.cpp
HardSceneParts body_spin();
HardSceneParts hands_through_shirt();
HardSceneParts fast_ball();
HardSceneParts teleport();
HardSceneParts dress_12000();
HardSceneParts armpit_pinch();
HardSceneParts crotch_pinch();
HardSceneParts closing_boxes();

// characters: character_scenes.cpp
HardSceneParts fast_cape();
HardSceneParts clipping_armature();

// cloth against itself: self_contact_cases.cpp
HardSceneParts falls_on_edge();
HardSceneParts two_layers();

// pins: pin_scenes.cpp
HardSceneParts yanked_corner();
HardSceneParts stretch_3();
HardSceneParts crumple();

/// A sheet that swings down by two clips onto a ball, which moves to and fro under it; what the
/// cases of fabric, mesh, gravity, place and time step vary: swing_scenes.cpp
struct SwingSettings {
    Fabric fabric = Fabric::soft_cotton();
    double gravity = 9.81;              ///< (m/s^2)
    Pose place = placed(Vec3::Zero());  ///< the scene with its gravity, moved and turned
    double dt = 1.0 / 30.0;
    double ball_rise = 0.0;  ///< during the first second (m)
};
HardSceneParts swing(const SwingSettings& settings);
HardSceneParts swing(const TriMesh& level, const SwingSettings& settings);

// long runs: soak_scenes.cpp
HardSceneParts soak_rest();
HardSceneParts soak_loop();
HardSceneParts soak_motion();  // motion_cases.cpp

}  // namespace cloth
