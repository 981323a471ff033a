#pragma once

#include <string>
#include <vector>

#include "demos/bake/scene_options.h"

namespace cloth {

struct BakeOptions : SceneOptions {
    int threads = 0;   ///< 0: all cores
    std::string out;   ///< the garment's cache
    std::string body;  ///< the body's; empty: none
    bool resume = false;
};

/// @throws UsageError naming the option; HelpText if it is asked for; ArgumentError for an unknown
///         ending of a cache, or if a file that is read would be overwritten
BakeOptions parse_bake_options(const std::vector<std::string>& arguments);

}  // namespace cloth
