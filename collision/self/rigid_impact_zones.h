#pragma once

#include <vector>

#include "collision/self/self_proximity.h"
#include "data/core/garment.h"

namespace cloth {

/// Groups of vertices that move like rigid bodies for one step, because nothing else keeps their
/// elements from passing through each other (Provot 1997, "Collision and self-collision handling in
/// cloth model dedicated to design garments"; Bridson, Fedkiw and Anderson 2002, section 7.5). What
/// moves rigidly cannot tangle; zones that touch become one.
///
/// A zone keeps the momentum and the angular momentum that its vertices had. One that holds pins
/// follows the mean motion of its pins instead; the pins themselves stay where they are.
class RigidImpactZones {
 public:
    /// @param masses  |V| (kg), above 0; none: the garment's
    explicit RigidImpactZones(const Garment& garment, const VectorX& masses = {});

    /// Forgets all zones. @param x  |V| x 3 (m): where the step would have ended
    void begin(const Points& x);

    /// Makes the vertices of each pair one zone, together with the zones they were in.
    void merge(const std::vector<SelfPair>& pairs);

    /// Moves the zones' vertices of `x` rigidly, from x0 on.
    /// @param turning  false: they keep their direction, and lose their angular momentum
    void apply(const Points& x0, bool turning, Points& x);

    int vertex_count() const { return static_cast<int>(m_members.size()); }  ///< in zones

 private:
    int root(int vertex);
    void move(const int* first, const int* last, const Points& x0, bool turning, Points& x) const;
    void follow_pins(const int* first, const int* last, const Points& x0, Points& x) const;

    VectorX m_masses;
    std::vector<char> m_pinned;
    Points m_free_x;             ///< |V| x 3 (m): without zones
    std::vector<int> m_parent;   ///< |V|, -1: in no zone
    std::vector<int> m_members;  ///< vertices in zones, zone by zone
};

}  // namespace cloth
