#pragma once

#include <string>
#include <vector>

namespace cloth {

struct ManyCharactersOptions {
    int characters = 10;                  ///< 1 to 200
    std::string garment = "tshirt_1000";  ///< of garment_names()
    std::vector<std::string> solvers = {"default", "small+3", "xpbd-40"};
    std::vector<std::string> motions;  ///< empty: crowd_motions()
    int frames = 30;                   ///< that are measured, of 1/30 s, 1 to 10000
    int warm_up = 60;                  ///< frames before them, 2 to 10000: the first second leads
                                       ///< from the rest pose into the motions
    int threads = 0;                   ///< 0: all cores that this process may use
    std::string out = "out/many_characters";
};

/// @throws UsageError naming the option and its choices; HelpText if it is asked for
ManyCharactersOptions parse_many_characters_options(const std::vector<std::string>& arguments);

}  // namespace cloth
