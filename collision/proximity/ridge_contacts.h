#pragma once

#include <vector>

#include "collision/proximity/proximity.h"
#include "data/core/garment.h"

namespace cloth {

/// Finds where a garment bends over a ridge of an obstacle (a box's edge, a finger): the vertices
/// of a face stand on skins that face different ways, and what holds them outside does not hold the
/// middle of the face, which would sink into the ridge.
///
///     RidgeFinder ridges(garment);
///     proximity.query(state.x, boundary, contacts);
///     ridges.find(proximity, boundary, state.x, contacts);  // fills contacts.ridges
///
/// Of the faces and edges that bend so, centres and midpoints near an obstacle get a contact of
/// their own. Cloth on smooth surfaces costs one comparison of normals per edge.
class RidgeFinder {
 public:
    explicit RidgeFinder(const Garment& garment);

    /// @param x         |V| x 3 (m), at the end of the step at which the nearest points are chosen
    /// @param contacts  the vertices' nearest points; `ridges` is replaced
    void find(Proximity& proximity, const Boundary& boundary, const Points& x,
              SurfaceContacts& contacts, StepEnd chosen_at = StepEnd::start);

 private:
    struct Sample {
        int face;
        std::array<double, 3> weight;  ///< of the face's corners
        std::array<int, 3> edge;       ///< that it lies on or between; an edge's midpoint: its own
    };
    int vertex(const Sample& sample, size_t corner) const {
        return m_faces(sample.face, static_cast<int>(corner));
    }
    void find_edges();
    void add_faces(const std::vector<char>& pinned);
    void add_edges(const std::vector<char>& pinned);
    void find_bent_edges(const SurfaceContacts& contacts, StepEnd chosen_at);
    bool bends(const Sample& sample) const;
    void place(int row, const Boundary& boundary, const Points& x);
    bool agrees(const RidgeContact& ridge, const SurfaceContacts& contacts) const;
    RidgeContact ridge(int row, StepEnd chosen_at) const;

    Faces m_faces;
    std::vector<std::array<int, 2>> m_edges;       ///< ascending
    std::vector<std::array<int, 3>> m_face_edges;  ///< |F|: from each corner to the next
    std::vector<char> m_in_reach;                  ///< |V|
    std::vector<char> m_bent;                      ///< |edges|: its ends stand on skins that part
    std::vector<Sample> m_samples;                 ///< centres of faces, then midpoints of edges
    Points m_x;                                    ///< |samples| x 3 (m)
    std::vector<int> m_rows;
    std::vector<char> m_wanted;      ///< scratch memory
    SurfaceContacts m_near;          ///< |samples|
    std::vector<LimbSet> m_ignored;  ///< |samples|: by any of its corners
};

}  // namespace cloth
