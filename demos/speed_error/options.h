#pragma once

#include <string>
#include <vector>

namespace cloth {

struct SpeedErrorOptions {
    std::vector<std::string> scenes = {"tshirt"};  ///< of scene_names(), or garments
    std::vector<std::string> fabrics = {"soft"};   ///< soft, real
    int rate = 30;                                 ///< frames and steps per second
    bool limbs = false;  ///< of the body: cloth passes through those that pass through others
    int frames = 30;
    int vertices = 4000;               ///< of the sheets
    int threads = 0;                   ///< 0: all cores that this process may use
    std::vector<std::string> solvers;  ///< empty: default_solvers()
    std::string relative_to;           ///< times are also given relative to this solver's; empty:
                                       ///< quasi-newton-3, if it takes part
    std::string weights;               ///< folder; empty: the committed weights
    std::string out = "out/speed_error";
};

/// @throws UsageError naming the option and its choices; HelpText if it is asked for
SpeedErrorOptions parse_speed_error_options(const std::vector<std::string>& arguments);

/// Every family of solvers at several settings: Bullet, XPBD, quasi-Newton, Newton, and the given
/// networks in the engine and, if it is there, in LibTorch.
std::vector<std::string> default_solvers(const std::vector<std::string>& networks, bool torch);

}  // namespace cloth
