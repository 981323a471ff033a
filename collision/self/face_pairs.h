#pragma once

#include <array>
#include <vector>

#include "collision/geometry/motion_tree.h"
#include "data/core/types.h"

namespace cloth {

/// Pairs of faces of one mesh that come near each other while its vertices move along straight
/// lines: the broad phase of self-collision.
///
///     FacePairs pairs(rest.vertices, rest.faces);
///     pairs.find(x, motion, 4e-3, threads);
///     for (const auto& [f, g] : pairs.found()) { ... may come within 4 mm ... }
///
/// Neighbours are always found. A hierarchy is descended down to groups of up to eight faces; of
/// two groups that are not apart, all pairs of faces are compared, eight at a time.
class FacePairs {
 public:
    FacePairs(const Points& rest, const Faces& faces);

    /// Replaces found() by a superset of the pairs that come within `distance` (m) of each other
    /// anywhere on the way from x to x + motion (|V| x 3, m). Each pair comes once, in an order
    /// that depends on the arguments alone.
    /// @param threads  0: as many as OpenMP gives
    void find(const Points& x, const Points& motion, double distance, int threads);

    const std::vector<std::array<int, 2>>& found() const { return m_found; }

 private:
    using Task = std::array<int, 2>;
    static constexpr int group_size = 8;
    /// The boxes of some faces (see MotionTree::Box), coordinate by coordinate.
    struct Group {
        float low[3][group_size], high[3][group_size];
        float least_motion[3][group_size], most_motion[3][group_size];
        int face[group_size];
        int leaf[group_size];  ///< nodes of the tree, -1 where there are fewer faces
    };

    void make_groups();
    void add_leaves(int node, int& count, Group& group) const;
    void fill(Group& group) const;
    bool is_group(int node) const { return m_group_of[static_cast<size_t>(node)] >= 0; }

    template <typename Emit>
    void expand(Task task, float distance, const Emit& emit) const;
    void make_tasks(float distance);
    void run_task(size_t index, float distance, std::vector<std::array<int, 2>>& result);
    void compare(Task groups, float distance, std::vector<std::array<int, 2>>& result) const;

    MotionTree m_tree;
    bool m_is_small;              ///< not worth waking threads for
    std::vector<int> m_group_of;  ///< of each node; -1: it has more faces, or is below a group
    std::vector<Group> m_groups;
    std::vector<Task> m_tasks, m_next_tasks;                 ///< of nodes
    std::vector<std::vector<Task>> m_stacks;                 ///< per task
    std::vector<std::vector<std::array<int, 2>>> m_results;  ///< per task
    std::vector<std::array<int, 2>> m_found;
};

}  // namespace cloth
