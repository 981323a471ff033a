#pragma once

#include <functional>
#include <string>
#include <vector>

#include "demos/compare/solver_factory.h"
#include "demos/hard_cases/hard_row.h"
#include "demos/hard_cases/pictures.h"

namespace cloth {

/// One case and who runs it.
struct HardContest {
    const HardCase* hard = nullptr;
    int frames = 0;
    std::vector<std::string> steppers;
    SolverSettings solver;
    std::vector<int> drawn = {};  ///< frames at which strips have the garment, ascending
    int starts = 1;               ///< of which all but the first only count as held or not
};

struct HardResult {
    HardRow row;
    HardStrip strip;
};

/// Makes each stepper for a scrap of cloth, so that names that cannot be used are known before the
/// expensive part begins. @throws UsageError, LoadError as make_solver() does
void check_steppers(const std::vector<std::string>& steppers, const SolverSettings& solver);

/// Frames of a case: scaled, at least one; the soak cases last for `soak_frames` if it is not 0.
int scaled_frames(const HardCase& hard, double scale, int soak_frames = 0);

/// Runs one of the contest's steppers, from each start with a solver of its own. The reference is
/// left out where it would take hours.
/// @param progress  done, of all, what
HardResult run_stepper(const HardContest& contest, const HardScene& scene,
                       const std::string& stepper,
                       const std::function<void(int, int, const std::string&)>& progress);

}  // namespace cloth
