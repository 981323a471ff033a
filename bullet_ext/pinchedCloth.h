#pragma once

#include <map>
#include <vector>

#include "bullet_ext/bulletObstacles.h"
#include "data/core/cloth_state.h"
#include "data/core/garment.h"

namespace cloth {

/// Cloth between two solids that close on it.
///
/// Bullet's bodies do not know of the cloth between them: they touch, and sink into each other for
/// some steps where they meet. Cloth has no room there, and what pushes it out of one pushes it
/// into the other. So room is made for it: the cloth sees the lighter solid moved away from the
/// other one, until both are two contact distances apart where cloth is between them. It keeps its
/// contacts with both, and friction. A solid that is pinched itself, such as one in a stack, or
/// between two walls, has nowhere to go: nodes that still have no room pass through the lighter of
/// the two, and keep to the other.
///
/// Animated meshes are left as they are, see LimbOverlap.
class PinchedCloth {
 public:
    /// Finds the cloth that has no room at the end of a step.
    /// @param solids   during the step; those that make room are moved
    /// @param owners   of the obstacles
    /// @param boundary obstacles that make room are moved, and ignored by nodes that have none
    void makeRoom(const Garment& garment, const ClothState& from, std::vector<NearSolid>& solids,
                  const std::vector<const btCollisionObject*>& owners, Boundary& boundary);

    /// Moves solids as makeRoom() did: to where the cloth sees them.
    void shift(std::vector<NearSolid>& solids) const;

    /// |V|: the solid that a pinched node keeps to (its number in `solids`), -1: it is not pinched.
    const std::vector<int>& keeper() const { return m_keeper; }
    /// |V|: the other one.
    const std::vector<int>& pincher() const { return m_pincher; }
    /// Whether a node passes through the solid of that number.
    bool ignores(int node, size_t solid) const;
    /// Nodes that found no room.
    int caught() const { return m_caught; }
    /// Whether the cloth sees any solid elsewhere than it is, or passes through it.
    bool movesSolids() const { return m_caught > 0 || !m_shifts.empty(); }

    /// Forgets the steps before.
    void forget() { m_shifts.clear(); }

 private:
    /// Two solids, and a point of the cloth between them.
    struct Pinch {
        std::array<int, 3> nodes;      ///< that the point lies between; the same ones for a node
        size_t keeper, pincher;        ///< numbers of solids
        Vec3 keeper_out, pincher_out;  ///< directions away from them, at the end of the step
        double room;                   ///< between them at the end (m), before room is made
    };
    struct Shift {
        Vec3 before = Vec3::Zero(), now = Vec3::Zero();  ///< (m): at both ends of the step
    };
    /// A solid during the step.
    struct Moving {
        NearSolid before;
        Pose motion;
    };
    /// A solid that a point of the cloth may come between.
    struct Near {
        size_t solid;     ///< its number
        double distance;  ///< (m): of the point, at the start of the step
        double reach;     ///< (m): how far the solid may be at the start and still be near
        Vec3 place;       ///< of the point, taken along by the solid
    };

    void findPinches(const Garment& garment, const Points& x, const std::vector<NearSolid>& solids);
    void testPoint(const Vec3& x, const std::array<int, 3>& nodes,
                   const std::vector<NearSolid>& solids);
    void testPair(const Vec3& x, const std::array<int, 3>& nodes, const NearSolid& other,
                  const Near& keeper, const Near& pincher);
    double roomOf(const Pinch& pinch) const;
    void separate();
    void markNodes(const std::vector<NearSolid>& solids,
                   const std::vector<const btCollisionObject*>& owners, Boundary& boundary);

    std::map<const btCollisionObject*, Vec3> m_shifts;  ///< of solids at the end of the last step
    std::vector<Pinch> m_pinches;
    std::vector<Moving> m_moving;  ///< of each solid
    std::vector<Near> m_near;      ///< of the point that is tested
    std::vector<Shift> m_shift;    ///< of each solid
    std::vector<double> m_yield;   ///< of each solid: the larger one makes room
    std::vector<int> m_keeper, m_pincher;
    std::vector<LimbSet> m_ignored;  ///< |V|: bit k is solid m_bits[k]
    std::vector<LimbSet> m_bits;     ///< of each solid, 0: nothing ignores it
    int m_caught = 0;
};

}  // namespace cloth
