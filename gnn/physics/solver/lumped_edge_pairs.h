#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "gnn/physics/energy/self_contact.h"

namespace cloth {

/// Which pairs of vertices and faces stand for a pair of edges in a matrix that only guides a
/// minimisation. Layers that lie on each other have more than twice as many pairs of edges, and
/// both kinds hold the same motions. As in the lumping of a mass matrix, each corner's pair takes
/// half of the corner's weight of the stiffness: layers that move apart as a whole are held as
/// before.
class LumpedEdgePairs {
 public:
    struct Lumped {
        size_t pair;                  ///< of edges: index in SelfContactEnergy::pairs()
        std::array<size_t, 4> to;     ///< pairs of its corners, on the same side of the other layer
        std::array<double, 4> share;  ///< their sum is 1
    };

    /// Takes the energy's pairs of edges but for those of which a corner has no pair of its own
    /// that points the same way. @param vertices  |V|
    void begin_step(const SelfContactEnergy& energy, size_t vertices);

    const std::vector<Lumped>& lumped() const { return m_lumped; }

 private:
    using Pair = SelfContactEnergy::Pair;
    void find_vertex_pairs(const SelfContactEnergy& energy, size_t vertices);
    bool find_corners(const std::vector<Pair>& pairs, const Pair& edges, Lumped& lumped) const;

    std::vector<size_t> m_begin;  ///< |V| + 1: the first pair of each vertex
    std::vector<Lumped> m_lumped;
};

}  // namespace cloth
