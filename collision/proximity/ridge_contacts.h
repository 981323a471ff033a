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
/// their own. Cloth on smooth surfaces costs one comparison of normals per edge of a face.
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
    };
    int vertex(const Sample& sample, size_t corner) const {
        return m_faces(sample.face, static_cast<int>(corner));
    }
    void add_faces(const std::vector<char>& pinned);
    void add_edges(const std::vector<char>& pinned);
    bool bends(const Sample& sample, const SurfaceContacts& contacts, StepEnd chosen_at) const;
    bool agrees(const RidgeContact& ridge, const SurfaceContacts& contacts) const;
    RidgeContact ridge(int row, StepEnd chosen_at) const;

    Faces m_faces;
    std::vector<Sample> m_samples;  ///< centres of faces, then midpoints of edges
    Points m_x;                     ///< |samples| x 3 (m)
    std::vector<int> m_rows;
    SurfaceContacts m_near;          ///< |samples|
    std::vector<LimbSet> m_ignored;  ///< |samples|: by any of its corners
};

}  // namespace cloth
