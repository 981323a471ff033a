#pragma once

#include <array>
#include <vector>

#include "collision/self/face_groups.h"
#include "data/core/types.h"

namespace cloth {

/// Pairs of faces of one mesh that come near each other while its vertices move along straight
/// lines: the broad phase of self-collision.
///
///     FacePairs pairs(rest.vertices, rest.faces);
///     pairs.find(x, motion, 4e-3, threads);
///     for (const auto& [f, g] : pairs.found()) { ... may come within 4 mm ... }
///
/// Neighbours are always found. Of two groups of faces that come near each other, all pairs of
/// faces are compared, eight at a time.
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
    static constexpr int width = FaceGroups::size;
    /// The boxes of a group's faces (see MotionTree::Box), coordinate by coordinate.
    struct Boxes {
        float low[3][width], high[3][width];
        float least_motion[3][width], most_motion[3][width];
    };

    void fill(int group);
    void compare(const std::array<int, 2>& groups, float distance,
                 std::vector<std::array<int, 2>>& result) const;

    FaceGroups m_groups;
    std::vector<Boxes> m_boxes;                              ///< of each group
    std::vector<std::vector<std::array<int, 2>>> m_results;  ///< per task
    std::vector<std::array<int, 2>> m_found;
};

}  // namespace cloth
