#pragma once

#include <array>
#include <vector>

#include "collision/response/plane_push.h"
#include "data/core/garment.h"

namespace cloth {

/// Keeps corrections from tearing at single edges: near the vertices that are moved, no edge may
/// become longer than a few per cent above what it was when the frame's corrections began, or above
/// its rest length. So the neighbours of a vertex that is lifted come along.
class StrainLimiter {
 public:
    /// @param growth  of an edge over the longer of its rest and its first length, 0.01 to 1
    StrainLimiter(const Garment& garment, double growth);

    /// Takes the lengths at `x` (|V| x 3, m), before corrections, as those to keep.
    void begin_frame(const Points& x);

    /// Adds planes for the edges within two rings of the vertices of the planes in `push`.
    void add_planes(const Points& x, PlanePush& push);

    /// How much longer than allowed the worst edge is (m), 0 if none is.
    double excess(const Points& x) const;

 private:
    double m_growth;
    std::vector<std::array<int, 2>> m_edges;
    VectorX m_rest, m_limit;     ///< |E| (m)
    std::vector<char> m_region;  ///< |V|: 1 a vertex of a plane, 2 and 3 its neighbours
};

}  // namespace cloth
