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
/// Neighbours are always found.
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

    template <typename Emit>
    void expand(Task task, float distance, const Emit& emit) const;
    void make_tasks(float distance);
    void run_task(size_t index, float distance, std::vector<std::array<int, 2>>& result);

    MotionTree m_tree;
    bool m_is_small;  ///< not worth waking threads for
    std::vector<Task> m_tasks, m_next_tasks;
    std::vector<std::vector<Task>> m_stacks;                 ///< per task
    std::vector<std::vector<std::array<int, 2>>> m_results;  ///< per task
    std::vector<std::array<int, 2>> m_found;
};

}  // namespace cloth
