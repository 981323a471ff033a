#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "demos/hard_cases/hard_scene.h"

namespace cloth {

/// What a garment must keep to for a solver to have held a case.
struct Bounds {
    static constexpr double none = std::numeric_limits<double>::infinity();

    double stretch_p99 = none;      ///< 99 % of the edges, in every frame: length over rest length
    double end_stretch_p99 = none;  ///< the same, in the last frame: it has recovered
    double penetration_mm = 1.0;    ///< deepest free vertex, in every frame
    double rest_jitter_mm = none;   ///< RMS motion per frame over the last third
    double rms_speed = none;        ///< over the vertices, in every frame (m/s)
    const char* reason = "";        ///< for these numbers
    double least_top_speed = 0.0;   ///< RMS speed (m/s) that some frame must reach: a solver that
                                    ///< does not get through a step moves cloth in slow motion
    double tangles = none;  ///< edges that pass through faces of the garment, in every frame
};

/// A scene on which cloth solvers fail.
struct HardCase {
    std::string name;
    std::string sentence;  ///< what happens
    int frames;            ///< of the case's time step, until it has happened
    Bounds bounds;
    std::function<HardSceneParts()> parts;
    /// If not 0: the bound of stretch is so many times what the reference has in its worst frame,
    /// where the reference was run.
    double stretch_of_reference = 0.0;
};

/// All cases, in the order in which they are run.
const std::vector<HardCase>& hard_cases();

/// @throws UsageError naming the cases there are
const HardCase& hard_case(const std::string& name);

}  // namespace cloth
