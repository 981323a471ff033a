#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "demos/hard_cases/hard_scene.h"

namespace cloth {

/// What a garment must keep to for a solver to have held a case.
struct Bounds {
    /// Length over rest length of 99 % of the edges, in every frame.
    std::optional<double> stretch_p99;
    std::optional<double> end_stretch_p99;  ///< the same, in the last frame: it has recovered
    double penetration_mm = 1.0;            ///< deepest free vertex, in every frame
    std::optional<double> rest_jitter_mm;   ///< RMS motion per frame over the last third
    std::optional<double> rms_speed;        ///< over the vertices, in every frame (m/s)
    /// RMS speed (m/s) that some frame must reach: a solver that does not get through a step moves
    /// cloth in slow motion.
    std::optional<double> least_top_speed;
    std::optional<int> tangles;  ///< edges that pass through faces of the garment, in every frame
    const char* reason = "";     ///< for these numbers
};

/// A scene on which cloth solvers fail.
struct HardCase {
    std::string name;
    std::string sentence;  ///< what happens
    int frames = 0;        ///< of the case's time step, until it has happened
    Bounds bounds;
    std::function<HardSceneParts()> parts;
    /// The bound of stretch is so many times what the reference has in its worst frame, where the
    /// reference was run.
    std::optional<double> stretch_of_reference = std::nullopt;
    std::string inputs = "";  ///< see HardRow::inputs
};

/// All cases, in the order in which they are run.
const std::vector<HardCase>& hard_cases();

/// @throws UsageError naming the cases there are
const HardCase& hard_case(const std::string& name);

}  // namespace cloth
