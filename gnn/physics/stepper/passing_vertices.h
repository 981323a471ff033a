#pragma once

#include <array>
#include <vector>

#include "collision/self/self_tangles.h"

namespace cloth {

/// Vertices of a garment that may pass through the rest of it in a step: those that are overlapped,
/// see Boundary, and those that were, as long as the cloth around them is tangled. When limbs part
/// again, layers that were in each other with them would hold each other, and be drawn off the
/// body.
///
/// What it decides depends on the steps before.
class PassingVertices {
 public:
    explicit PassingVertices(const Garment& garment);

    /// @param x0          |V| x 3 (m): where the step begins; a step from the same x0 is the same
    ///                    one, taken again
    /// @param overlapped  |V|, or empty
    /// @param tangles     at x0; null: there are none
    void begin_step(const Points& x0, const std::vector<char>& overlapped,
                    const std::vector<Tangle>* tangles);

    const std::vector<char>& passing() const { return m_passing; }  ///< |V|, or empty
    /// What is overlapped and the vertices of tangled elements, which may be on the wrong side:
    /// nothing should repel them (|V|, or empty). All that passes would tangle more.
    const std::vector<char>& unrepelled() const { return m_unrepelled; }

 private:
    void keep_tangled(const std::vector<Tangle>& tangles);
    void keep(int vertex);
    template <typename Visit>
    void visit_vertices(const std::vector<Tangle>& tangles, const Visit& visit) const;

    std::vector<std::array<int, 2>> m_edges;
    Faces m_faces;
    std::vector<std::vector<int>> m_neighbours;  ///< |V|
    Points m_x0;                                 ///< |V| x 3 (m): of this step
    std::vector<char> m_before;                  ///< |V|, or empty: passing in the step before
    std::vector<char> m_passing, m_unrepelled;
    std::vector<char> m_kept;    ///< |V|: of m_before, scratch memory
    std::vector<int> m_reached;  ///< likewise
};

}  // namespace cloth
