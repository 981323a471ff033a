#pragma once

#include <array>
#include <vector>

#include "collision/fcl_hierarchy.h"
#include "data/types.h"

namespace cloth {

/// Pairs of faces of one mesh that come near each other while its vertices move along straight
/// lines: the broad phase of self-collision.
///
///     FacePairs pairs(rest.vertices, rest.faces);
///     pairs.find(x, motion, 4e-3, threads);
///     for (const auto& [f, g] : pairs.found()) { ... may come within 4 mm ... }
///
/// A hierarchy (FCL's, over the rest mesh) holds for each node the box of its vertices and the box
/// of their motions. Two nodes are told apart by their relative motion, so a garment that flies
/// through the room as a whole costs no more than one that rests. Neighbours are always found.
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
    /// Coordinates in single precision, widened by what they are rounded by; the fourth lane,
    /// always zero, lets the compiler compare all in one instruction.
    struct Node {
        float low[4], high[4];                  ///< of the vertices at t (m, from m_origin)
        float least_motion[4], most_motion[4];  ///< during the step (m)
        int left, right;                        ///< -1 in a leaf
        int face;                               ///< of a leaf
        int face_count;                         ///< faces below
    };
    using Task = std::array<int, 2>;

    void refit(const Points& x, const Points& motion);
    void refit_leaf(Node& node, const Points& x, const Points& motion) const;
    static bool are_apart(const Node& a, const Node& b, float distance);
    template <typename Emit>
    void expand(Task task, float distance, const Emit& emit) const;
    void make_tasks(float distance);
    void run_task(size_t index, float distance, std::vector<std::array<int, 2>>& result);

    Faces m_faces;
    std::vector<Node> m_nodes;
    Eigen::RowVector3d m_origin = Eigen::RowVector3d::Zero();
    float m_rounding = 0.0f;  ///< of a coordinate (m)
    std::vector<Task> m_tasks, m_next_tasks;
    std::vector<std::vector<Task>> m_stacks;                 ///< per task
    std::vector<std::vector<std::array<int, 2>>> m_results;  ///< per task
    std::vector<std::array<int, 2>> m_found;
};

}  // namespace cloth
