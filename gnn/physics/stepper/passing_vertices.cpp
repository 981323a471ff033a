#include "gnn/physics/stepper/passing_vertices.h"

#include "data/core/vertex_neighbours.h"

namespace cloth {

PassingVertices::PassingVertices(const Garment& garment)
    : m_edges(garment.edges()),
      m_faces(garment.rest().faces),
      m_neighbours(vertex_neighbours(garment)) {
}

void PassingVertices::begin_step(const Points& x0, const std::vector<char>& overlapped,
                                 const std::vector<Tangle>* tangles) {
    if (!same_points(x0, m_x0)) {
        m_before.swap(m_passing);
        m_x0 = x0;
    }
    m_passing = overlapped;
    if (tangles && !m_before.empty()) keep_tangled(*tangles);
    m_unrepelled = overlapped;
    if (!tangles) return;
    m_unrepelled.resize(m_neighbours.size(), 0);
    visit_vertices(*tangles, [&](int i) { m_unrepelled[static_cast<size_t>(i)] = 1; });
}

template <typename Visit>
void PassingVertices::visit_vertices(const std::vector<Tangle>& tangles, const Visit& visit) const {
    for (const Tangle& tangle : tangles) {
        for (const int i : m_edges[static_cast<size_t>(tangle.edge)]) visit(i);
        for (int k = 0; k < 3; ++k) visit(m_faces(tangle.face, k));
    }
}

/// What passed before and hangs together with something of it that is tangled.
void PassingVertices::keep_tangled(const std::vector<Tangle>& tangles) {
    m_passing.resize(m_before.size(), 0);
    m_reached.clear();
    m_kept.assign(m_before.size(), 0);
    visit_vertices(tangles, [&](int i) { keep(i); });
    for (size_t k = 0; k < m_reached.size(); ++k)
        for (const int j : m_neighbours[static_cast<size_t>(m_reached[k])]) keep(j);
}

void PassingVertices::keep(int vertex) {
    const auto i = static_cast<size_t>(vertex);
    if (m_before[i] == 0 || m_kept[i] != 0) return;
    m_kept[i] = 1;
    m_passing[i] = 1;
    m_reached.push_back(vertex);
}

}  // namespace cloth
