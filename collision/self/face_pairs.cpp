#include "collision/self/face_pairs.h"

#include <algorithm>
#include <limits>

#include "collision/geometry/eight_lanes.h"
#include "collision/geometry/gather_in_order.h"

namespace cloth {
namespace {

constexpr int pairs_at_once = 256;  // of groups, that a thread takes

}  // namespace

FacePairs::FacePairs(const Points& rest, const Faces& faces)
    : m_groups(rest, faces), m_boxes(m_groups.count()) {
}

/// A lane without a face has a box that is apart from all.
void FacePairs::fill(int group) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    Boxes& boxes = m_boxes[static_cast<size_t>(group)];
    const FaceGroups::Lanes& faces = m_groups.faces(group);
    for (int lane = 0; lane < width; ++lane) {
        const bool none = faces[static_cast<size_t>(lane)] < 0;
        for (int k = 0; k < 3; ++k) {
            const MotionTree::Box* box = none ? nullptr : &m_groups.box(group, lane);
            boxes.low[k][lane] = box ? box->low[k] : infinity;
            boxes.high[k][lane] = box ? box->high[k] : -infinity;
            boxes.least_motion[k][lane] = box ? box->least_motion[k] : 0.0f;
            boxes.most_motion[k][lane] = box ? box->most_motion[k] : 0.0f;
        }
    }
}

/// MotionTree::are_apart() of each face of one group with all of the other.
void FacePairs::compare(const std::array<int, 2>& groups, float distance,
                        std::vector<std::array<int, 2>>& result) const {
    const Boxes& a = m_boxes[static_cast<size_t>(groups[0])];
    const Boxes& b = m_boxes[static_cast<size_t>(groups[1])];
    const FaceGroups::Lanes &first = m_groups.faces(groups[0]), &second = m_groups.faces(groups[1]);
    const EightFloats zero = {};
    for (size_t i = 0; i < width && first[i] >= 0; ++i) {
        EightFlags near = {-1, -1, -1, -1, -1, -1, -1, -1};
        for (int k = 0; k < 3; ++k) {
            const EightFloats least = a.least_motion[k][i] - load_eight(b.most_motion[k]);
            const EightFloats most = a.most_motion[k][i] - load_eight(b.least_motion[k]);
            const EightFloats down = smaller(least, zero), up = larger(most, zero);
            near &= (a.low[k][i] + down <= load_eight(b.high[k]) + distance) &
                    (a.high[k][i] + up >= load_eight(b.low[k]) - distance);
        }
        unsigned lanes = bits(near);
        if (groups[0] == groups[1]) lanes &= ~1u << i;  // each pair once
        for_each_lane(lanes, [&](size_t lane) {
            result.push_back({std::min(first[i], second[lane]), std::max(first[i], second[lane])});
        });
    }
}

void FacePairs::find(const Points& x, const Points& motion, double distance, int threads) {
    m_groups.find(x, motion, distance, threads);
    for (size_t group = 0; group < m_groups.count(); ++group) fill(static_cast<int>(group));
    const float reach = m_groups.widened(distance);
    const auto& pairs = m_groups.found();
    const auto find = [&](int k, std::vector<std::array<int, 2>>& result) {
        compare(pairs[static_cast<size_t>(k)], reach, result);
    };
    gather_each_in_order(static_cast<int>(pairs.size()), m_groups.worthwhile(threads), m_results,
                         m_found, find, pairs_at_once);
}

}  // namespace cloth
