#pragma once

#include <vector>

#include "collision/self/face_pairs.h"
#include "collision/self/self_elements.h"

namespace cloth {

/// An edge of a garment that passes through one of its faces.
struct Tangle {
    int edge = -1, face = -1;   ///< indices into Garment::edges() and the rest mesh's faces
    Vec3 point = Vec3::Zero();  ///< where they cross (m)
};

/// Where the edge p0-p1 crosses the face abc; false: nowhere. Touching counts or not by rounding;
/// an edge in the plane of the face does not.
bool edge_crosses_face(const Vec3& p0, const Vec3& p1, const Vec3& a, const Vec3& b, const Vec3& c,
                       Vec3& point);

/// Finds where a garment passes through itself, or its pieces through each other. Surfaces that
/// cross along a line tangle in each edge that the line cuts.
///
///     SelfTangles tangles(garment);
///     if (tangles.find(state.x).size() > 0) { ... report tangles.found()[0].point ... }
class SelfTangles {
 public:
    explicit SelfTangles(const Garment& garment);

    /// @param x           |V| x 3 (m); from positions that are not finite no tangles are found
    /// @param threads     0: as many as OpenMP gives
    /// @param overlapped  |V|, or empty: vertices at which tangles do not count, see Boundary
    const std::vector<Tangle>& find(const Points& x, int threads = 0,
                                    const std::vector<char>& overlapped = {});

    /// Whether a vertex of its edge or face is marked (|V|).
    bool is_at(const Tangle& tangle, const std::vector<char>& marked) const;

    const std::vector<Tangle>& found() const { return m_found; }  ///< whatever the threads

 private:
    void add(int edge, int face, const Points& x, std::vector<Tangle>& out) const;

    SelfElements m_elements;
    FacePairs m_faces;
    Points m_still;  ///< |V| x 3: no motion
    std::vector<Tangle> m_found;
    std::vector<std::vector<Tangle>> m_parts;
};

}  // namespace cloth
