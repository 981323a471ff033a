#pragma once

#include <string>
#include <vector>

namespace cloth {

struct HardCaseOptions {
    std::vector<std::string> cases;       ///< empty: all, or none if there are motions
    std::vector<std::string> motions;     ///< names, BVH files or folders of them: a case each
    std::string garment = "tshirt_1000";  ///< of these cases
    bool limbs = true;  ///< in these cases cloth passes through limbs that pass through others
    std::vector<std::string> steppers;  ///< see default_hard_case_steppers()
    double frames_scale = 1.0;          ///< of each case's frames, 0.001 to 1000
    int starts = 1;                     ///< of each case, 1 to 1000, see HardScene::start_from()
    bool soak = false;                  ///< the soak cases run for 10,000 frames
    bool list = false;                  ///< name the cases and stop
    bool pictures = true;
    bool films = false;
    bool markdown = false;  ///< print the table in Markdown, too
    bool resume = false;    ///< keep the rows that are in the file already
    int threads = 0;        ///< of the engine; 0: all cores
    std::string weights;    ///< folder; empty: the committed weights
    std::string out = "out/hard_cases";
};

/// The reference, quasi-Newton with and without sub-steps, XPBD, the network with its safeguard
/// and alone, Bullet.
std::vector<std::string> default_hard_case_steppers();

/// @throws UsageError naming the option, or the cases there are; HelpText if it is asked for
HardCaseOptions parse_hard_case_options(const std::vector<std::string>& arguments);

}  // namespace cloth
