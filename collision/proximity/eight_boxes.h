#pragma once

#include <limits>

#include "collision/geometry/eight_lanes.h"
#include "data/core/types.h"

namespace cloth {

/// Eight boxes of a node of ClosestFaceTree, by axis.
using EightBounds = Eigen::Array<float, 8, 1>[3];

/// Squared distances of a point to boxes.
inline EightFloats box_distances(const EightBounds& low, const EightBounds& high,
                                 const Eigen::Vector3f& q) {
    EightFloats sum = {};
    for (int k = 0; k < 3; ++k) {
        const EightFloats below = load_eight(low[k].data()) - q[k],
                          above = q[k] - load_eight(high[k].data());
        const EightFloats outside = larger(larger(below, above), EightFloats{});
        sum += outside * outside;
    }
    return sum;
}

/// Slab test of a ray from q with boxes: how far along it enters them, infinity: it does not.
/// @param inverse  1 / direction
inline EightFloats box_entries(const EightBounds& low, const EightBounds& high,
                               const Eigen::Vector3f& q, const Eigen::Vector3f& inverse,
                               float length) {
    EightFloats enter = {}, leave = enter + length;
    for (int k = 0; k < 3; ++k) {
        const EightFloats a = (load_eight(low[k].data()) - q[k]) * inverse[k];
        const EightFloats b = (load_eight(high[k].data()) - q[k]) * inverse[k];
        enter = larger(enter, smaller(a, b));
        leave = smaller(leave, larger(a, b));
    }
    return enter <= leave ? enter : EightFloats{} + std::numeric_limits<float>::infinity();
}

}  // namespace cloth
