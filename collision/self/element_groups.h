#pragma once

#include <array>
#include <vector>

#include "collision/geometry/eight_lanes.h"
#include "collision/self/face_groups.h"
#include "collision/self/self_elements.h"

namespace cloth {

/// Pairs of elements of one mesh that may be near each other while its vertices move along straight
/// lines. Of groups of faces that come near each other, those elements that come near the other
/// group's box are compared eight at a time, by the spheres around them and around their motions:
/// in single precision, with room for what that rounds off.
///
///     ElementGroups groups(garment, ElementGroups::Which::near);
///     groups.find(x, motion, reach, threads);
///     for (int k = 0; k < groups.found(); ++k)
///         groups.visit(k, [&](const ElementPair& pair, int f, int g) {
///             ... elements of faces f and g may come within reach ...
///         });
class ElementGroups {
 public:
    /// near: pairs that may come within reach; facing: of these, those that may face each other at
    /// x, see ClosestPoints, where no neighbour of the face is nearer to the vertex, see
    /// OffsetRegions.
    enum class Which { near, facing };

    ElementGroups(const Garment& garment, Which which);

    /// @param x, motion  |V| x 3 (m)  @param reach  (m)  @param threads  0: as many as OpenMP gives
    void find(const Points& x, const Points& motion, double reach, int threads);
    /// The same again with other motions of some vertices, for pairs that have one of these.
    /// @param changed  |V|: not 0 where the motion differs from that of the last search
    void find_changed(const Points& x, const Points& motion, const std::vector<char>& changed,
                      double reach, int threads);
    /// Pairs of groups, in an order that depends on the arguments of the search alone.
    int found() const { return static_cast<int>(m_found.size()); }

    /// Calls visit(pair, f, g) for a superset of such pairs of the k-th pair of groups. They share
    /// no vertex. The first element is owned by face f, the second by g, or is g itself. Over all k
    /// each pair comes once.
    template <typename Visit>
    void visit(int k, const Visit& visit) const;

    static constexpr int pairs_at_once = 64;  ///< pairs of groups that a thread should take at once
    /// How many threads a search is worth, where so many are allowed.
    int worthwhile(int threads) const { return m_groups.worthwhile(threads); }

 private:
    static constexpr int width = FaceGroups::size;
    /// A sphere around the motions of each element's points (m).
    struct Motions {
        float mean[3][width], radius[width];
    };
    /// The faces of a group; lanes without one are far from all.
    struct Discs {
        float centre[3][width], normal[3][width];  ///< unit
        float radius[width];
        Motions motion;
        FaceGroups::Lanes face;
    };
    /// The corners of a group's faces, and of the faces beyond the edges from each corner to the
    /// next the third: where there is none, the corner again.
    struct Rings {
        float corner[3][3][width], beyond[3][3][width];
    };
    /// Eight edges of a group; lanes without one are far from all.
    struct Rods {
        float middle[3][width], half[3][width];  ///< from there to an end
        float length[width];                     ///< of the half
        Motions motion;
        std::array<int, width> edge, face;  ///< -1: none
    };
    /// Eight vertices of a group; lanes without one are far from all.
    struct Corners {
        float at[3][width], motion[3][width];
        std::array<int, width> vertex, face;  ///< -1: none
    };
    /// Of a group's faces (m).
    struct Box {
        float low[3], high[3], least_motion[3], most_motion[3];
    };
    /// First of a group's corners, or rods.
    struct Begin {
        size_t corners, rods;
    };
    static constexpr size_t most_packs = FaceGroups::size * 3 / width;  ///< of a group
    using Near = std::array<unsigned, most_packs>;  ///< a bit for each lane, per pack

    void make_groups();
    void measure(const Points& x, const Points& motion, double reach);
    bool has_any(const std::vector<char>& marked, size_t group) const;
    void update(const Points& x, const Points& motion, size_t group);
    void update_faces(const Points& x, const Points& motion, size_t group);
    void update_rings(size_t group);
    void update(const Points& x, const Points& motion, Corners& corners) const;
    void update(const Points& x, const Points& motion, Rods& rods) const;
    // A bit for each lane.
    unsigned compare(const Corners& corners, const Box& box) const;
    unsigned compare(const Rods& rods, const Box& box) const;
    unsigned compare(const Corners& corners, size_t lane, const Discs& discs) const;
    unsigned compare(const Rods& a, size_t lane, const Rods& b) const;
    unsigned nearer_beyond(const Corners& corners, size_t lane, size_t group) const;
    Near near_edges(size_t group, size_t other) const;  ///< those that come near the other's box
    template <typename Visit>
    void visit_corners(size_t a, size_t b, const Visit& visit) const;
    template <typename Visit>
    void visit_edges(size_t a, size_t b, const Visit& visit) const;

    Which m_which;
    SelfElements m_elements;
    std::vector<std::array<int, 3>> m_beyond_face;  ///< see OffsetRegions; near: empty
    FaceGroups m_groups;
    std::vector<std::array<int, 2>> m_found;
    std::vector<char> m_changed;                 ///< of each group, scratch memory
    std::vector<Begin> m_begin;                  ///< groups + 1
    std::vector<Discs> m_discs;                  ///< of each group
    std::vector<Rings> m_rings;                  ///< likewise; near: empty
    std::vector<std::array<float, 3>> m_places;  ///< |V| (m), from the first; near: empty
    std::vector<Box> m_boxes;
    std::vector<Rods> m_rods;
    std::vector<Corners> m_corners;
    Vec3 m_origin = Vec3::Zero();  ///< (m): the first vertex
    float m_reach = 0.0f;          ///< (m)
    float m_rounding = 0.0f;       ///< of a difference of coordinates (m)
    float m_box_reach = 0.0f;      ///< m_reach, with room for what is rounded off (m)
};

template <typename Visit>
void ElementGroups::visit(int k, const Visit& visit) const {
    const auto& pair = m_found[static_cast<size_t>(k)];
    const auto a = static_cast<size_t>(pair[0]), b = static_cast<size_t>(pair[1]);
    visit_corners(a, b, visit);
    if (a != b) visit_corners(b, a, visit);
    visit_edges(a, b, visit);
}

template <typename Visit>
void ElementGroups::visit_corners(size_t a, size_t b, const Visit& visit) const {
    const Discs& discs = m_discs[b];
    for (size_t c = m_begin[a].corners; c < m_begin[a + 1].corners; ++c) {
        const Corners& corners = m_corners[c];
        for_each_lane(compare(corners, m_boxes[b]), [&](size_t i) {
            const int v = corners.vertex[i];
            unsigned lanes = compare(corners, i, discs);
            for_each_lane(lanes, [&](size_t lane) {
                const auto at = m_elements.faces().row(discs.face[lane]);
                if (v == at[0] || v == at[1] || v == at[2]) lanes &= ~(1u << lane);
            });
            if (lanes != 0 && m_which == Which::facing) lanes &= ~nearer_beyond(corners, i, b);
            for_each_lane(lanes, [&](size_t lane) {
                const int g = discs.face[lane];
                const auto at = m_elements.faces().row(g);
                visit(ElementPair{{v, at[0], at[1], at[2]}, {v, g}, false}, corners.face[i], g);
            });
        });
    }
}

template <typename Visit>
void ElementGroups::visit_edges(size_t a, size_t b, const Visit& visit) const {
    const auto& edges = m_elements.edges();
    const size_t begin = m_begin[b].rods;
    const Near of_a = near_edges(a, b), of_b = near_edges(b, a);
    for (size_t r = m_begin[a].rods; r < m_begin[a + 1].rods; ++r)
        for_each_lane(of_a[r - m_begin[a].rods], [&](size_t i) {
            const int first = m_rods[r].edge[i];
            const auto [a0, a1] = edges[static_cast<size_t>(first)];
            for (size_t s = a == b ? r : begin; s < m_begin[b + 1].rods; ++s) {
                unsigned lanes = of_b[s - begin];
                if (r == s) lanes &= ~1u << i;  // each pair once
                if (lanes != 0) lanes &= compare(m_rods[r], i, m_rods[s]);
                for_each_lane(lanes, [&, a0 = a0, a1 = a1](size_t lane) {
                    const int second = m_rods[s].edge[lane];
                    const auto [b0, b1] = edges[static_cast<size_t>(second)];
                    if (a0 != b0 && a0 != b1 && a1 != b0 && a1 != b1)
                        visit(ElementPair{{a0, a1, b0, b1}, {first, second}, true},
                              m_rods[r].face[i], m_rods[s].face[lane]);
                });
            }
        });
}

}  // namespace cloth
