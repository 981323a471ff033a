#pragma once

#include <string>
#include <vector>

#include "demos/compare/arguments.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/solver_factory.h"

namespace cloth {

struct CompareOptions {
    std::string garment = "tshirt";
    std::string body = "default";  ///< that wears it, see body_named()
    std::string motion = "01_01";
    std::string fabric = "soft";  ///< soft (SNUG's cotton, 33 N/m) or real (5 kN/m)
    std::vector<std::string> solvers;
    int rate = 30;              ///< frames and steps per second
    int frames = 90;            ///< of the motion, after the second in which the garment settles
    int reference_frames = 30;  ///< frames that the references are computed for; 0: all
    int threads = 0;            ///< 0: all cores
    std::string weights;        ///< folder of trained weights; empty: the committed ones
    std::string out = "out/compare";
    bool video = true;
    std::string worker;  ///< internal: measure only this solver, in this process
};

BodySceneSettings scene_settings(const CompareOptions& options);
SolverSettings solver_settings(const CompareOptions& options);

/// @throws UsageError naming the option; HelpText if it is asked for
CompareOptions parse_compare_options(const std::vector<std::string>& arguments);

/// The arguments that make another process do the work `worker` of these options.
std::vector<std::string> worker_arguments(const CompareOptions& options, const std::string& worker);

}  // namespace cloth
