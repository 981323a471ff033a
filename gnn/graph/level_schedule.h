#pragma once

#include <string>
#include <vector>

#include "gnn/graph/coarse_levels.h"

namespace cloth {

constexpr int max_coarse_levels = 6;

/// For each message step the levels that send messages in it, finest first: 0 is the mesh itself,
/// 1 the level made of it, and so on. One or two levels per step.
///
/// Nodes of a level are nodes of the finer ones, too. So a step updates the nodes of its first
/// level; the others keep their latents.
using LevelSchedule = std::vector<std::vector<int>>;

/// Down and up again as in HOOD, whose 15 steps are three times each of {0, 1}, {1, 2}, {2}, {1, 2}
/// and {0, 1}. Where `steps` is no multiple of the 2 levels + 1 stages, stages far from the middle
/// get one step more, the last one first.
/// @throws ArgumentError if levels are not 1 to max_coarse_levels, or steps fewer than stages
LevelSchedule down_and_up(int steps, int levels);

/// The coarsest level in use; 0 for an empty schedule.
int coarsest_level(const LevelSchedule& schedule);

/// Without pooling the schedule is empty: each step uses the mesh.
/// @param owner  of the schedule, for errors
/// @throws ArgumentError if the schedule does not fit the steps and the pooling
void check_levels(const std::string& owner, int steps, Pooling pooling,
                  const LevelSchedule& schedule);

}  // namespace cloth
