#pragma once

#include <string>
#include <vector>

namespace cloth {

struct BulletScenesOptions {
    std::vector<std::string> scenes;  ///< empty: all
    std::vector<std::string> solvers = {"bullet", "default", "small"};
    std::vector<int> rates = {60};              ///< of even steps (Hz)
    std::vector<std::string> steps = {"even"};  ///< of even and random
    int seconds = 10;                           ///< 1 to 600
    bool list = false;
    bool videos = true;
    std::string reference = "quasi-newton-30";  ///< whose last shape is right
    std::string weights;
    std::string out = "out/bullet_scenes";
};

/// @throws UsageError naming the option, or the scenes there are; HelpText if it is asked for
BulletScenesOptions parse_bullet_scenes_options(const std::vector<std::string>& arguments);

}  // namespace cloth
