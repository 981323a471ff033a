#pragma once

#include <array>
#include <vector>

#include "collision/proximity/proximity.h"
#include "data/core/garment.h"

namespace cloth {

/// The points of a garment's surface, besides its vertices, that are kept outside of obstacles: the
/// centres of its faces, then the midpoints of its edges. Those between pinned vertices are left
/// out.
///
/// Only samples that can be deep are searched for: the signed distance changes by no more than a
/// point moves, so the distances of its vertices bound that of a face's centre, and the centre's,
/// which is nearer to the midpoints than any vertex, those of its edges' midpoints. Vertices that
/// are farther outside than all edges are long need not be looked at so closely. Where skins
/// face each other there are no such bounds: parts of a body may overlap there, and where they do
/// the sign of the distance jumps.
class SurfaceSamples {
 public:
    /// The vertices of a sample, and their share in it; an edge leaves the third with share 0.
    struct Corners {
        std::array<int, 3> vertex;
        std::array<double, 3> weight;
        int count() const { return weight[2] > 0.0 ? 3 : 2; }
        Vec3 position(const Points& x) const {
            return weight[0] * x.row(vertex[0]) + weight[1] * x.row(vertex[1]) +
                   weight[2] * x.row(vertex[2]);
        }
    };

    explicit SurfaceSamples(const Garment& garment);

    /// Finds the samples deeper than `depth` (m) at t + dt.
    /// @param x         |V| x 3 (m)
    /// @param contacts  the vertices' nearest points, chosen at t + dt
    /// @param changed   |V|: only samples of these vertices have changed since the last call, whose
    ///                  `depth` was not larger; null: all may have
    void find_deep(Proximity& proximity, const Boundary& boundary, const Points& x,
                   const SurfaceContacts& contacts, double depth, const std::vector<char>* changed);

    /// How deep the samples of some vertices are at t + dt (m): the deepest of those that are
    /// movable; 0: none is inside. Leaves deep() as it is, and new positions of these samples
    /// and contacts of those inside.
    /// @param changed  |V|: these vertices
    double depth_beside(Proximity& proximity, const Boundary& boundary, const Points& x,
                        const std::vector<char>& changed);

    int count() const { return static_cast<int>(m_x.rows()); }
    /// Whether not all of its vertices are pinned.
    bool is_movable(int sample) const { return m_movable[static_cast<size_t>(sample)] != 0; }
    /// Limbs that any vertex of a deep sample passes through.
    LimbSet ignored(int sample) const { return m_ignored[static_cast<size_t>(sample)]; }
    const std::vector<int>& deep() const { return m_deep; }  ///< samples, ascending
    double max_depth() const;                                ///< of the deep ones, or 0 (m)

    Corners corners(int sample) const;
    /// A face of the garment that the sample lies on, and the share of its corners in it.
    struct OnFace {
        int face;
        std::array<double, 3> weight;
    };
    OnFace on_face(int sample) const;
    Vec3 position(int sample) const { return m_x.row(sample); }  ///< in the last call (m)
    Vec3 way_out(int sample) const;  ///< unit direction from a deep sample to its nearest point
    const SurfaceContacts& contacts() const { return m_contacts; }  ///< |samples|, of the deep ones

 private:
    int face_count() const { return static_cast<int>(m_faces.rows()); }
    template <class IsUnsure>
    void search_unsure(Proximity& proximity, const Boundary& boundary, int first, int last,
                       double depth, const IsUnsure& is_unsure);
    void limit_search(int sample, const Boundary& boundary, double radius);
    void query_rows(Proximity& proximity, const Boundary& boundary, double depth);
    void find_clear(const Points& x, const SurfaceContacts& contacts);
    bool is_clear(int sample) const;
    bool has_changed(int sample, const std::vector<char>* changed) const;
    bool skins_part(int sample, const SurfaceContacts& contacts) const;
    double vouched_by_vertices(int sample, const Points& x, const VectorX& clearance) const;
    double vouched_by_faces(int edge) const;

    Faces m_faces;
    std::vector<std::array<int, 2>> m_edges, m_edge_faces;  ///< the faces at an edge, -1: none
    Points m_x;                                             ///< |samples| x 3 (m)
    VectorX m_radii;             ///< |samples| (m): how far a sample is searched for
    VectorX m_distance;          ///< |samples| (m): a lower bound, exact where searched
    SurfaceContacts m_contacts;  ///< |samples|
    std::vector<int> m_rows, m_deep;
    std::vector<LimbSet> m_ignored;  ///< |samples|: by any of its vertices
    std::vector<char> m_parted;      ///< |samples|: its vertices stand on skins that part
    std::vector<char> m_clear;       ///< |V|: no sample of it is deep, or near skins that part
    std::vector<char> m_unsure;      ///< scratch memory
    std::vector<char> m_movable;     ///< |samples|: not all of its vertices are pinned
    double m_radius = 0.0;
};

}  // namespace cloth
