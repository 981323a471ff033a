#pragma once

#include <vector>

#include "collision/geometry/fcl_hierarchy.h"
#include "data/core/types.h"

namespace cloth {

/// A hierarchy (FCL's, over the rest mesh) that holds for each node the box of its vertices and the
/// box of their motions during a step. Two nodes are told apart by their relative motion, so what
/// moves together costs no more than what rests.
class MotionTree {
 public:
    /// Coordinates in single precision from the tree's origin; the fourth lane, always zero, lets
    /// the compiler compare all in one instruction.
    struct Box {
        float low[4], high[4];                  ///< at t (m)
        float least_motion[4], most_motion[4];  ///< during the step (m)
    };
    struct Node {
        Box box;
        int left, right;  ///< -1 in a leaf
        int face;         ///< of a leaf
        int face_count;   ///< faces below
    };

    MotionTree(const Points& rest, const Faces& faces);

    /// Follows the vertices from x to x + motion (|V| x 3, m).
    void refit(const Points& x, const Points& motion);

    bool is_empty() const { return m_nodes.empty(); }
    const Node& node(int index) const { return m_nodes[static_cast<size_t>(index)]; }

    /// The box of a point that moves from x to x + motion, wider than what it is rounded by.
    Box box_of(const Vec3& x, const Vec3& motion) const;

    /// `distance` (m) in single precision, plus what coordinates of the tree are rounded by.
    float widened(double distance) const {
        return static_cast<float>(distance) * (1.0f + 1e-6f) + 4.0f * m_rounding;
    }

    /// Calls visit(face) for each face whose box is not apart from `box`, and does not move with it
    /// by less than `least_motion` (m) in each coordinate; `stack` is scratch memory.
    template <typename Visit>
    void for_each_met(const Box& box, float least_motion, std::vector<int>& stack,
                      const Visit& visit) const {
        const float reach = widened(0.0);
        stack.clear();
        if (!is_empty()) stack.push_back(0);
        while (!stack.empty()) {
            const Node& at = node(stack.back());
            stack.pop_back();
            if (are_apart(at.box, box, reach) || move_together(at.box, box, least_motion)) continue;
            if (at.left < 0) {
                visit(at.face);
                continue;
            }
            stack.push_back(at.left);
            stack.push_back(at.right);
        }
    }

    /// Whether the box of a, drawn along the motions that its points can have as seen from b, stays
    /// further than the distance from the box of b in one of the coordinates.
    static bool are_apart(const Box& a, const Box& b, float distance) {
        bool apart = false;
        for (int k = 0; k < 4; ++k) {
            const float least = a.least_motion[k] - b.most_motion[k];
            const float most = a.most_motion[k] - b.least_motion[k];
            const float down = least < 0.0f ? least : 0.0f;
            const float up = most > 0.0f ? most : 0.0f;
            apart |=
                (a.low[k] + down > b.high[k] + distance) | (a.high[k] + up < b.low[k] - distance);
        }
        return apart;
    }

    /// Whether all points of a move as those of b do, but for less than `least` (m) in each
    /// coordinate.
    static bool move_together(const Box& a, const Box& b, float least) {
        bool together = true;
        for (int k = 0; k < 4; ++k)
            together &= (a.most_motion[k] - b.least_motion[k] < least) &
                        (b.most_motion[k] - a.least_motion[k] < least);
        return together;
    }

 private:
    using Vec4f = Eigen::Array4f;

    void localize(const Points& x, const Points& motion);
    void refit_leaf(Node& node) const;

    Faces m_faces;
    std::vector<Node> m_nodes;          ///< parents before their children
    std::vector<Vec4f> m_at, m_motion;  ///< |V|: in single precision, from the origin (m)
    Eigen::RowVector3d m_origin = Eigen::RowVector3d::Zero();
    float m_rounding = 0.0f;  ///< of a coordinate (m)
};

}  // namespace cloth
