#pragma once

#include <string>
#include <vector>

namespace cloth {

struct PaperOptions {
    std::vector<std::string> garments;  ///< of garment_names(); empty: those of the plan
    std::vector<std::string> solvers;   ///< as make_solver() knows them; empty: those of the plan
    int frames = 0;                     ///< of 1/30 s, up to 100,000; 0: as the plan says
    int threads = 0;                    ///< 0: all cores that this process may use
    std::string weights;                ///< folder; empty: the committed weights
    std::string neighbours;             ///< report of train_series; empty: the committed one
    std::string train;                  ///< the program; empty: training is not measured
    int training_iterations = 120;      ///< of the longer of two short trainings, 40 to 100,000
    bool again = false;                 ///< measures what is measured, too
    std::string note;                   ///< of the circumstances, shown with the figures
    std::string references;             ///< folder that keeps them; empty: parts in `out`
    std::string out = "out/paper_tables";
};

/// @throws UsageError naming the option and its choices; HelpText if it is asked for
PaperOptions parse_paper_options(const std::vector<std::string>& arguments);

}  // namespace cloth
