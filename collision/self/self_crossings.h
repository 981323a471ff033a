#pragma once

#include <vector>

#include "collision/self/self_proximity.h"

namespace cloth {

/// Elements of a garment that pass through each other during a step: continuous collision
/// detection.
///
/// Each is given as a SelfPair of the moment at which the two are about to touch: its normal points
/// to the side on which the first element was before.
class SelfCrossings {
 public:
    /// @param parts  faces of one part may pass through each other
    explicit SelfCrossings(const Garment& garment, FaceParts parts = {});

    /// Replaces found() by the pairs whose elements touch when all vertices move evenly from x0 to
    /// x1 (|V| x 3, m). None is missed whose elements are apart by more than rounding at x0; those
    /// that are not, such as where the cloth is tangled, have no side and are passed over. From the
    /// same x0 as before, only pairs are looked at of which a vertex goes elsewhere.
    /// @param threads     0: as many as OpenMP gives
    /// @param passing     |V|, or empty: vertices whose pairs are passed over
    const std::vector<SelfPair>& find(const Points& x0, const Points& x1, int threads,
                                      const std::vector<char>& passing = {});

    /// In an order that depends on the arguments alone.
    const std::vector<SelfPair>& found() const { return m_found; }

    /// Whether none was passed over: what was untangled at x0 and is not found is so at x1.
    bool passed_over_none() const { return m_passed_over_none; }

 private:
    void find_all(const Points& x0, int threads, const std::vector<char>& passing);
    void find_changed(const Points& x0, const Points& x1, int threads);
    void add_changed(const Points& x0, int threads);

    ElementGroups m_groups;
    FaceParts m_parts_of_faces;
    Points m_x0, m_x1;            ///< |V| x 3 (m): of the last search
    std::vector<char> m_passing;  ///< of the last search
    Points m_motion;              ///< |V| x 3 (m)
    std::vector<char> m_changed;  ///< |V|: the motion is another one than in the last search
    std::vector<SelfPair> m_found, m_new;
    std::vector<std::vector<SelfPair>> m_parts;
    bool m_passed_over_none = false;
};

/// Whether two elements touch on the way from x0 to x0 + motion, and as what pair. Conservative
/// advancement: they are moved on by what they are apart, over the fastest that they can approach
/// (Li, Kaufman and Jiang 2021, "Codimensional incremental potential contact", section 5.4).
bool crosses(const ElementPair& elements, const Points& x0, const Points& motion, SelfPair& pair);

}  // namespace cloth
