#pragma once

#include <algorithm>

#include "gnn/stepper.h"

namespace cloth {

/// Adds what a part of a step reports to the report of the parts before it. `substeps` stays.
inline void add_part(const StepReport& part, StepReport& report) {
    report.finite = part.finite;
    report.iterations += part.iterations;
    report.residual = part.residual;
    report.gain = part.gain;
    report.converged = part.converged && report.converged;
    report.out_of_time = part.out_of_time || report.out_of_time;
    report.prediction_rejected = part.prediction_rejected || report.prediction_rejected;
    report.max_penetration = part.max_penetration;
    report.max_entry = std::max(report.max_entry, part.max_entry);
    if (part.tunnelled)
        report.tunnelled = std::min(*part.tunnelled, report.tunnelled.value_or(*part.tunnelled));
    report.points_tunnelled = std::max(report.points_tunnelled, part.points_tunnelled);
    report.vertices_in_ignored_limbs = part.vertices_in_ignored_limbs;
    report.max_ignored_depth = part.max_ignored_depth;
    report.vertices_beyond_goals = part.vertices_beyond_goals;
    report.max_goal_excess = part.max_goal_excess;
    report.tangles = part.tangles;
    report.first_tangle = part.first_tangle;
    report.times += part.times;
}

}  // namespace cloth
