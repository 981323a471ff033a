#pragma once

#include <array>
#include <vector>

#include "collision/proximity/proximity.h"
#include "collision/response/plane_push.h"
#include "collision/response/strain_limiter.h"
#include "collision/self/rigid_impact_zones.h"
#include "collision/self/self_contact_settings.h"
#include "collision/self/self_crossings.h"
#include "data/core/skin_goals.h"

namespace cloth {

/// What SelfResolver did in one step.
struct SelfResolveReport {
    int crossings = 0;  ///< pairs of elements that would have passed through each other
    int rounds = 0;     ///< of pushes
    int rigid = 0;      ///< vertices that had to move like rigid bodies in the end
    int left = 0;       ///< pairs that still pass, such as between pins that cross
    /// Whether what was untangled at t is so at t + dt; false: not known.
    bool keeps_untangled = false;
};

/// Contact projection of a step for cloth that passes through itself: pairs of elements that
/// would do so between t and t + dt are put back on the side that they come from.
///
///     SelfResolver resolver(garment, settings);
///     resolver.resolve(state.x, contacts, 5e-4, x);
///
/// First by the smallest motion, weighted with the masses, that keeps linear momentum, holds
/// vertices outside of obstacles and near their goals, and does not stretch the cloth; what is not
/// solved so within the rounds moves rigidly for this step. Cloth that does not cross keeps its
/// bits. What is tangled at t stays as it is: its elements are not taken apart, and do not get
/// deeper.
class SelfResolver {
 public:
    /// @throws ArgumentError if a setting is out of range
    SelfResolver(const Garment& garment, const SelfContactSettings& settings);
    /// @param masses  |V| (kg), above 0
    /// @param parts   of faces that may pass through each other
    SelfResolver(const Garment& garment, const SelfContactSettings& settings, const VectorX& masses,
                 const FaceParts& parts);

    /// @param x0        |V| x 3 (m): positions at t, which say what side is right
    /// @param contacts  nearest points of `x` on the obstacles, chosen at t + dt, or empty
    /// @param distance  of vertices from the obstacles (m) that is held
    /// @param x         |V| x 3 (m): positions at t + dt; pinned vertices do not move
    /// @param may_pass  cloth that would be drawn out to more than 1.5 of its length is let go, and
    ///                  passes through: for what is tangled at t, and untangled afterwards
    /// @param goals     at t + dt, of vertices that are limited
    /// @param passing   |V|, or empty: vertices whose pairs may pass
    SelfResolveReport resolve(const Points& x0, const SurfaceContacts& contacts, double distance,
                              Points& x, bool may_pass = false,
                              const std::vector<VertexGoal>& goals = {},
                              const std::vector<char>& passing = {});

    /// Vertices that the last resolve() may have moved, each once.
    const std::vector<int>& moved() const { return m_moved; }
    /// Pairs that would have passed through each other in the last resolve(), in any round.
    const std::vector<SelfPair>& pairs() const { return m_pairs; }

 private:
    void push(const SurfaceContacts& contacts, double distance,
              const std::vector<VertexGoal>& goals, Points& x);
    void hold_vertices(const SurfaceContacts& contacts, double distance);
    void hold_at_goals(const std::vector<VertexGoal>& goals, const Points& x);
    void hold_at_goal(const VertexGoal& goal, const Vec3& x, const Vec3& along);
    void hold(int vertex, const Vec3& normal, double height);
    double gap(const ElementPair& elements) const;
    bool release_torn(const SurfaceContacts& contacts, Points& x) const;
    void note_moved(const Points& x);

    SelfContactSettings m_settings;
    SelfCrossings m_crossings;
    PlanePush m_push;
    StrainLimiter m_guard;
    RigidImpactZones m_zones;
    Points m_rest;  ///< |V| x 3 (m)
    std::vector<std::array<int, 2>> m_edges;
    std::vector<int> m_piece;
    VectorX m_free_masses;                  ///< |V| (kg); none where there are pins
    std::vector<SelfPair> m_pairs;          ///< of all rounds
    std::vector<char> m_held;               ///< |V|
    std::vector<const VertexGoal*> m_goal;  ///< |V|, scratch memory
    std::vector<int> m_moved;
    Points m_before;  ///< |V| x 3 (m): where the step would have ended
};

}  // namespace cloth
