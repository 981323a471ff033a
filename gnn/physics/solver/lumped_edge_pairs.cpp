#include "gnn/physics/solver/lumped_edge_pairs.h"

#include <cmath>

namespace cloth {
namespace {

constexpr double alike = 0.8;  // cosine between directions that stand for each other

}  // namespace

void LumpedEdgePairs::begin_step(const SelfContactEnergy& energy, size_t vertices) {
    m_lumped.clear();
    if (energy.vertex_pairs() == 0) return;
    find_vertex_pairs(energy, vertices);
    const std::vector<Pair>& pairs = energy.pairs();
    for (size_t k = energy.vertex_pairs(); k < pairs.size(); ++k) {
        Lumped lumped{k, {}, {}};
        if (find_corners(pairs, pairs[k], lumped)) m_lumped.push_back(lumped);
    }
}

void LumpedEdgePairs::find_vertex_pairs(const SelfContactEnergy& energy, size_t vertices) {
    m_begin.assign(vertices + 1, 0);
    for (size_t k = 0; k < energy.vertex_pairs(); ++k)
        ++m_begin[static_cast<size_t>(energy.pairs()[k].vertex[0]) + 1];
    for (size_t i = 0; i < vertices; ++i) m_begin[i + 1] += m_begin[i];
}

/// The most alike of each corner's pairs; false if a corner has none.
bool LumpedEdgePairs::find_corners(const std::vector<Pair>& pairs, const Pair& edges,
                                   Lumped& lumped) const {
    for (size_t corner = 0; corner < 4; ++corner) {
        const auto vertex = static_cast<size_t>(edges.vertex[corner]);
        const double side = edges.weight[corner] < 0.0 ? -1.0 : 1.0;
        double most = alike;
        for (size_t k = m_begin[vertex]; k < m_begin[vertex + 1]; ++k)
            if (const double cosine = side * edges.normal.dot(pairs[k].normal); cosine > most) {
                most = cosine;
                lumped.to[corner] = k;
            }
        if (!(most > alike)) return false;
        lumped.share[corner] = 0.5 * std::abs(edges.weight[corner]);
    }
    return true;
}

}  // namespace cloth
