#pragma once

#include <string>
#include <vector>

namespace cloth {

struct LookbookOptions {
    std::vector<std::string> garments = {"tshirt", "tank_top", "long_top", "shirt",       "pants",
                                         "shorts", "skirt",    "dress",    "tshirt+pants"};
    std::vector<std::string> bodies;  ///< see body_named(); empty: all that there are
    std::string motion = "01_01";
    std::string solver = "small";
    int frames = 0;    ///< of 1/30 s; 0: all of the motion
    int picture = 71;  ///< frame that is in the picture; the last one if there are fewer
    int threads = 0;   ///< 0: all cores
    std::string out = "out/lookbook";
    bool video = true;
};

/// @throws UsageError naming the option; HelpText if it is asked for
LookbookOptions parse_lookbook_options(const std::vector<std::string>& arguments);

}  // namespace cloth
