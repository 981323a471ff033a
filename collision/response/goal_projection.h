#pragma once

#include <vector>

#include "collision/proximity/proximity.h"
#include "collision/response/contact_projection.h"
#include "data/core/garment.h"

namespace cloth {

/// What GoalProjection found and left.
struct GoalReport {
    int moved = 0;            ///< vertices that were beyond their limits
    double max_move = 0.0;    ///< how far the farthest was (m)
    int beyond = 0;           ///< vertices that still are: an obstacle is in the way
    double max_excess = 0.0;  ///< how far the farthest of them is (m)
    int iterations = 0;       ///< of queries
};

/// Brings vertices that end a step beyond the limits of their skinned goals back, exactly.
///
/// Where an obstacle is in the way, the obstacle wins: no vertex is put into one. A vertex whose
/// goal is outside of all obstacles always has a place that is allowed and outside, and is put
/// there, at the goal itself if nowhere else. One whose goal is inside, and which has no such place
/// on the way to it, is put on the surface where that is nearest to the goal. Edges and faces may
/// sink in between vertices that their goals hold. Pins move to their targets, whatever goals say.
///
///     GoalProjection goals(garment);
///     goals.begin_step(boundary.goals);
///     ResolveReport report = goals.finish(contact_projection, proximity, boundary, 5e-4, x,
///                                         contacts);
///
/// Without goals it is contact projection alone.
class GoalProjection {
 public:
    /// Keeps a reference to `garment`.
    explicit GoalProjection(const Garment& garment) : m_garment(&garment) {}

    /// Takes the goals at t + dt.
    void begin_step(const SkinGoals& goals);

    /// Contact projection, then goals, and both once more where goals moved something.
    /// @param distance  of vertices from the surfaces at t + dt (m)
    /// @param x         |V| x 3 (m), the pinned vertices in place
    /// @param contacts, way_in  see ContactProjection::resolve()
    ResolveReport finish(ContactProjection& projection, Proximity& proximity,
                         const Boundary& boundary, double distance, Points& x,
                         SurfaceContacts& contacts,
                         const ContactProjection::WayIn& way_in = nullptr);

    /// Goals alone.
    /// @param contacts  of |V| rows where there are obstacles; brought up to date for what moves
    void resolve(Proximity& proximity, const Boundary& boundary, double distance, Points& x,
                 SurfaceContacts& contacts);

    /// Those at t + dt of vertices that are limited.
    const std::vector<VertexGoal>& goals() const { return m_goals; }
    /// What the last resolve() did.
    const GoalReport& last() const { return m_last; }
    const std::vector<int>& moved() const { return m_moved; }  ///< vertices, by the last resolve()

 private:
    struct Inside {
        size_t goal;
        Vec3 from;  ///< where the search towards the goal begins (m)
    };

    void bring_within(Points& x);
    void keep_those_inside(const SurfaceContacts& contacts);
    void alternate(Proximity& proximity, const Boundary& boundary, Points& x,
                   SurfaceContacts& contacts);
    void search_towards_goals(Proximity& proximity, const Boundary& boundary, Points& x,
                              SurfaceContacts& contacts);
    void query(Proximity& proximity, const Boundary& boundary, const Points& x,
               SurfaceContacts& contacts);
    void measure(const Points& x);

    const Garment* m_garment;
    std::vector<VertexGoal> m_goals;
    std::vector<Inside> m_inside;  ///< what is inside an obstacle
    std::vector<int> m_rows;       ///< |inside|: its vertices
    std::vector<int> m_moved;
    GoalReport m_last;
};

}  // namespace cloth
