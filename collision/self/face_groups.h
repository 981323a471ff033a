#pragma once

#include <array>
#include <vector>

#include "collision/geometry/motion_tree.h"
#include "data/core/types.h"

namespace cloth {

/// The faces of a mesh in groups of up to eight that lie together, and the pairs of groups that
/// come near each other while the vertices move along straight lines: a hierarchy is descended down
/// to the groups.
///
///     FaceGroups groups(rest.vertices, rest.faces);
///     groups.find(x, motion, 4e-3, threads);
///     for (const auto& [a, b] : groups.found()) { ... groups.faces(a), groups.faces(b) ... }
class FaceGroups {
 public:
    static constexpr int size = 8;
    using Lanes = std::array<int, size>;

    FaceGroups(const Points& rest, const Faces& faces);

    size_t count() const { return m_faces.size(); }
    /// -1 where there are fewer.
    const Lanes& faces(int group) const { return m_faces[static_cast<size_t>(group)]; }
    /// Of face `lane` of a group, in the last find().
    const MotionTree::Box& box(int group, int lane) const {
        return m_tree.node(m_leaves[static_cast<size_t>(group)][static_cast<size_t>(lane)]).box;
    }

    /// Replaces found() by a superset of the pairs with faces that come within `distance` (m) of
    /// each other anywhere on the way from x to x + motion (|V| x 3, m); each group is a pair with
    /// itself, too. Each pair comes once, in an order that depends on the arguments alone.
    /// @param threads  0: as many as OpenMP gives
    void find(const Points& x, const Points& motion, double distance, int threads);

    const std::vector<std::array<int, 2>>& found() const { return m_found; }

    /// `distance` (m) for comparisons of boxes.
    float widened(double distance) const { return m_tree.widened(distance); }
    /// How many threads a search is worth, where so many are allowed.
    int worthwhile(int threads) const { return m_is_small ? 1 : threads; }

 private:
    using Task = std::array<int, 2>;

    void make_groups();
    void add_leaves(int node, int& count, Lanes& leaves, Lanes& faces) const;
    int group_of(int node) const { return m_group_of[static_cast<size_t>(node)]; }
    bool is_group(int node) const { return group_of(node) >= 0; }

    template <typename Emit>
    void expand(Task task, float distance, const Emit& emit) const;
    void make_tasks(float distance);
    void run_task(size_t index, float distance, std::vector<Task>& result);

    MotionTree m_tree;
    bool m_is_small;              ///< not worth waking threads for
    std::vector<int> m_group_of;  ///< of each node; -1: it has more faces, or is below a group
    std::vector<Lanes> m_faces, m_leaves;     ///< of each group; leaves are nodes of the tree
    std::vector<Task> m_tasks, m_next_tasks;  ///< of nodes
    std::vector<std::vector<Task>> m_stacks;  ///< per task
    std::vector<std::vector<Task>> m_results;
    std::vector<std::array<int, 2>> m_found;
};

}  // namespace cloth
