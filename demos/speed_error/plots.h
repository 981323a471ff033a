#pragma once

#include <string>
#include <vector>

#include "demos/speed_error/solver_row.h"

namespace cloth {

/// A diagram as SVG and the end of its file's name.
struct NamedPlot {
    std::string name;
    std::string svg;
};

/// Time per frame against each kind of error, for the rows of one scene and fabric: gap, progress,
/// rmse (rollout to the reference of 1/30 s) and fine_rmse (to that of 1/240 s). Each family of
/// solvers has a colour and a line through its settings; failed rollouts are crosses. An error of 0
/// has no place on a logarithmic axis.
std::vector<NamedPlot> speed_error_plots(const std::vector<SolverRow>& rows);

}  // namespace cloth
