#include "collision/self/tangled_regions.h"

#include <algorithm>

#include "data/core/garment_pieces.h"

namespace cloth {

TangledRegions::TangledRegions(const Garment& garment)
    : m_edges(garment.edges()),
      m_area(garment.masses()),
      m_piece(garment_pieces(garment)),
      m_cut(m_edges.size(), 0),
      m_parent(m_piece.size()),
      m_side(m_piece.size()),
      m_component(m_piece.size()),
      m_was_wrong(m_piece.size(), 0),
      m_wrong(m_piece.size(), 0) {
    const size_t pieces =
        m_piece.empty()
            ? 0
            : static_cast<size_t>(*std::max_element(m_piece.begin(), m_piece.end())) + 1;
    m_largest.resize(pieces);
    m_sides.resize(pieces);
}

void TangledRegions::find(const std::vector<Tangle>& tangles, const std::vector<char>* known) {
    m_left_out = false;
    std::fill(m_wrong.begin(), m_wrong.end(), 0);
    if (tangles.empty()) return;
    std::fill(m_cut.begin(), m_cut.end(), 0);
    for (const Tangle& tangle : tangles) m_cut[static_cast<size_t>(tangle.edge)] ^= 1;
    join_uncut();
    choose_sides();
    mark_smaller();
    if (known) leave_out(*known);
}

int TangledRegions::root(int vertex) {
    while (m_parent[static_cast<size_t>(vertex)] != vertex) {
        int& above = m_parent[static_cast<size_t>(vertex)];
        above = m_parent[static_cast<size_t>(above)];
        vertex = above;
    }
    return vertex;
}

/// Components, each with its lowest vertex as the root.
void TangledRegions::join_uncut() {
    for (size_t i = 0; i < m_parent.size(); ++i) m_parent[i] = static_cast<int>(i);
    for (size_t e = 0; e < m_edges.size(); ++e) {
        if (m_cut[e]) continue;
        const int a = root(m_edges[e][0]), b = root(m_edges[e][1]);
        m_parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
    }
    std::fill(m_component.begin(), m_component.end(), 0.0);
    for (size_t i = 0; i < m_parent.size(); ++i)
        m_component[static_cast<size_t>(root(static_cast<int>(i)))] +=
            m_area[static_cast<Eigen::Index>(i)];
}

/// From the largest component of each piece on, the other side across each cut.
void TangledRegions::choose_sides() {
    std::fill(m_largest.begin(), m_largest.end(), -1);
    for (size_t i = 0; i < m_parent.size(); ++i) {
        if (m_parent[i] != static_cast<int>(i)) continue;
        int& largest = m_largest[static_cast<size_t>(m_piece[i])];
        if (largest < 0 || m_component[i] > m_component[static_cast<size_t>(largest)])
            largest = static_cast<int>(i);
    }
    std::fill(m_side.begin(), m_side.end(), -1);
    for (const int largest : m_largest) m_side[static_cast<size_t>(largest)] = 0;
    m_neighbours.clear();
    for (size_t e = 0; e < m_edges.size(); ++e) {
        if (!m_cut[e]) continue;
        const int a = root(m_edges[e][0]), b = root(m_edges[e][1]);
        if (a != b) m_neighbours.push_back({a, b});
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (const auto& [a, b] : m_neighbours) {
            int &first = m_side[static_cast<size_t>(a)], &second = m_side[static_cast<size_t>(b)];
            if ((first < 0) == (second < 0)) continue;
            (first < 0 ? first : second) = 1 - std::max(first, second);
            changed = true;
        }
    }
}

void TangledRegions::mark_smaller() {
    std::fill(m_sides.begin(), m_sides.end(), std::array<double, 2>{0.0, 0.0});
    for (size_t i = 0; i < m_parent.size(); ++i)
        if (m_parent[i] == static_cast<int>(i))
            m_sides[static_cast<size_t>(m_piece[i])][static_cast<size_t>(m_side[i])] +=
                m_component[i];
    for (size_t i = 0; i < m_parent.size(); ++i) {
        const auto& [first, second] = m_sides[static_cast<size_t>(m_piece[i])];
        const int wrong = second > first ? 0 : 1;
        m_wrong[i] = m_side[static_cast<size_t>(root(static_cast<int>(i)))] == wrong;
    }
}

void TangledRegions::leave_out(const std::vector<char>& known) {
    std::fill(m_was_wrong.begin(), m_was_wrong.end(), 0);
    for (size_t i = 0; i < m_wrong.size(); ++i)
        if (known[i]) m_was_wrong[static_cast<size_t>(root(static_cast<int>(i)))] = 1;
    for (size_t i = 0; i < m_wrong.size(); ++i) {
        if (!m_wrong[i] || m_was_wrong[static_cast<size_t>(root(static_cast<int>(i)))]) continue;
        m_wrong[i] = 0;
        m_left_out = true;
    }
}

}  // namespace cloth
