#pragma once

#include <array>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "data/core/skin_goals.h"

namespace cloth {

/// Limits of one vertex in the order of goal_names(), and of them what is painted.
struct PaintedVertex {
    std::array<double, 4> values{std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::infinity(), 0.0, 0.0};

    /// Whatever holds a vertex more: smaller distances, stronger drives.
    void tighten(const PaintedVertex& other);
};

/// max_distance, backstop, drive_stiffness, drive_damping.
const std::array<std::string, 4>& goal_names();
/// Which of them a name in a file means, without regard to capitals: -1 for none.
int goal_named(std::string name);

/// @throws LoadError unless the value is in the range of GoalLimits
void check_painted(const std::string& path, const std::string& place, int goal, double value);

/// What attributes say of one part of a file.
struct PaintedPart {
    std::array<bool, 4> has{};                             ///< which of the limits
    std::map<std::array<float, 3>, PaintedVertex> places;  ///< by the position in the file
    std::vector<PaintedVertex> rows;  ///< by the number of the vertex; of these two one is empty

    bool any() const { return has[0] || has[1] || has[2] || has[3]; }
};

/// Parts of a glTF (a part per primitive) or PLY file that have goal attributes; none for others.
/// The file is one that assimp has read.
/// @throws LoadError see load_painted_mesh()
std::vector<PaintedPart> read_painted_parts(const std::string& path);
std::vector<PaintedPart> read_painted_gltf(const std::string& path);
std::vector<PaintedPart> read_painted_ply(const std::string& path);

}  // namespace cloth
