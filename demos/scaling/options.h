#pragma once

#include <string>
#include <vector>

namespace cloth {

struct ScalingOptions {
    std::vector<std::string> scenes = {"sphere", "dress"};  ///< of scaling_scenes()
    /// Numbers of vertices, 500 to 60000 each.
    std::vector<int> vertices = {1000, 2000, 4000, 8000, 12000, 25000, 50000};
    std::vector<std::string> solvers = {"default", "small+3", "xpbd-40"};
    int frames = 12;  ///< that are measured, of 1/30 s, 1 to 1000
    int warm_up = 3;  ///< frames before them, 0 to 1000
    int threads = 0;  ///< 0: all cores that this process may use
    std::string out = "out/scaling";
};

/// @throws UsageError naming the option and its choices; HelpText if it is asked for
ScalingOptions parse_scaling_options(const std::vector<std::string>& arguments);

}  // namespace cloth
