#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "data/core/pose.h"
#include "data/core/skin_goals.h"
#include "data/core/types.h"

namespace cloth {

/// A set of limbs of obstacles: bit k is limb k.
using LimbSet = std::uint32_t;
constexpr int max_limbs = 32;

enum class ObstacleShape { mesh, sphere, capsule, box, plane };

enum class StepEnd { start, end };  ///< surfaces at t, or at t + dt

/// One solid surface that cloth must stay outside of, at the start (t) and end (t + dt) of a step.
///
/// A mesh keeps its `faces` for life (the query structure is cached by that pointer) and moves its
/// vertices. The primitives stand in their own frame: a sphere at the origin; a capsule along y; a
/// box with half extents; a plane through the origin, solid on the side y < 0.
struct Obstacle {
    ObstacleShape shape = ObstacleShape::mesh;
    std::shared_ptr<const Faces> faces;  ///< mesh: (|F| x 3), counter-clockwise seen from outside
    /// Mesh: limb of each face (|F|, 0 to 31), the same pointer for life; null: the mesh is one
    /// body. Cloth passes through limbs that are inside other limbs, see LimbOverlap.
    std::shared_ptr<const std::vector<std::uint8_t>> limbs;
    /// Mesh with limbs: tells it from other obstacles of the same mesh in every step. 0: its place
    /// among them in Boundary::obstacles does.
    int id = 0;
    /// Mesh: vertices touch all of it, whatever limbs they ignore. LimbOverlap sets it for other
    /// characters than the one that cloth belongs to.
    bool is_whole = false;
    /// Bit of the whole obstacle, as if it were a limb: vertices that ignore it do not touch the
    /// obstacle. 0: all touch it. To be told apart from limbs of other obstacles.
    LimbSet solid = 0;
    Points x0;                         ///< mesh: vertices at t (m)
    Points x1;                         ///< mesh: vertices at t + dt (m)
    Pose pose0 = Pose::Identity();     ///< primitive: frame at t
    Pose pose1 = Pose::Identity();     ///< primitive: frame at t + dt
    Vec3 half_extents = Vec3::Zero();  ///< box (m); capsule: y is half the segment's length
    double radius = 0.0;               ///< sphere and capsule (m); box: rounding
    double friction = 0.5;             ///< Coulomb coefficient, 0 to 1.5
};

/// Whether these are one limb for each of a mesh's faces, all of them from 0 to 31.
inline bool are_limbs_of(const Faces& faces, const std::vector<std::uint8_t>& limbs) {
    static_assert((max_limbs & (max_limbs - 1)) == 0, "out of range: a bit above is set");
    unsigned bits = 0;
    for (const std::uint8_t limb : limbs) bits |= limb;
    return limbs.size() == static_cast<std::size_t>(faces.rows()) && bits < max_limbs;
}

/// Whether a mesh has a usable limb for each face. It looks at each: not for inner loops.
inline bool has_limbs(const Obstacle& mesh) {
    return mesh.limbs && mesh.faces && are_limbs_of(*mesh.faces, *mesh.limbs);
}

class ObstacleTrees;  // collision/proximity/obstacle_trees.h

/// All that a stepper knows of the outside for one step.
struct Boundary {
    std::vector<Obstacle> obstacles;
    Points pin_targets;                  ///< |pins| x 3 (m): where the garment's pins are at t + dt
    Vec3 gravity = Vec3(0, -9.81, 0);    ///< (m/s^2)
    Points accelerations;                ///< |V| x 3 (m/s^2) such as wind, or empty
    SkinGoals goals;                     ///< of garments with goal limits; else not looked at
    std::vector<LimbSet> ignored_limbs;  ///< |V|: limbs and solids that a vertex does not touch, or
                                         ///< empty; LimbOverlap adds limbs
    /// |V|: not 0 where a vertex lies between two skins that are folded onto each other: friction
    /// holds it. Or empty; LimbOverlap fills it.
    std::vector<char> pinched;
    /// |V|: not 0 where skins overlap, or leave no room for layers of cloth: there cloth passes
    /// through cloth. Or empty; LimbOverlap can fill it.
    std::vector<char> overlapped;
    /// Hierarchies of the mesh obstacles that all garments of a world share; null: whoever queries
    /// obstacles has its own. Results are the same. Leave it null for poses that only one garment
    /// meets, such as those of sub-steps: they would crowd out those of the world.
    std::shared_ptr<ObstacleTrees> trees;
};

/// The limbs that a vertex does not touch.
inline LimbSet ignored_limbs(const Boundary& boundary, int vertex) {
    const auto i = static_cast<std::size_t>(vertex);
    return i < boundary.ignored_limbs.size() ? boundary.ignored_limbs[i] : 0;
}

inline bool is_pinched(const Boundary& boundary, Eigen::Index vertex) {
    const auto i = static_cast<std::size_t>(vertex);
    return i < boundary.pinched.size() && boundary.pinched[i] != 0;
}

}  // namespace cloth
