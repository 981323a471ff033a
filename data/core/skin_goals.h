#pragma once

#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// How free each vertex of a garment is to leave its *goal*: the place that a skinned character
/// gives it in each pose. Games paint these; the names are those of Unreal's Chaos Cloth.
///
///     GoalLimits limits;
///     limits.max_distance.setConstant(garment.vertex_count(), 0.1);  // m
///     limits.backstop.setConstant(garment.vertex_count(), 0.02);     // m
///     const Garment cape = garment.with_goals(limits);
///     boundary.goals = SkinGoals::at(cape.rest().vertices);  // in each step, see SkinGoals
///
/// Constant data, part of the Garment. Each array has one value per vertex, or none, which leaves
/// all vertices free of what it limits. Limits on pinned vertices are without effect.
struct GoalLimits {
    /// How far a vertex may be from its goal at the end of a step (m), 0 to infinity. 0: it is at
    /// its goal; infinity: it may be anywhere.
    VectorX max_distance;
    /// How far behind its goal, against the goal's normal, it may be (m), 0 to infinity. Infinity:
    /// as far as it likes.
    VectorX backstop;
    /// A soft pull to the goal, as an acceleration per distance (1/s^2), 0 to 1e6: a vertex alone
    /// swings about its goal with the square root of it (rad/s). Being per mass, it does not depend
    /// on how fine the mesh is, or on how heavy the fabric.
    VectorX drive_stiffness;
    /// How fast what a vertex moves relative to its goal dies away (1/s), 0 to 1e4.
    VectorX drive_damping;

    /// Whether no vertex is limited or driven; then goals cost nothing.
    bool empty() const;
    bool has_backstops() const;
};

/// @param owner  for the message, such as the garment's name
/// @throws ArgumentError if an array has another size than 0 or `vertices`, or a value is out of
///         range or NaN
void check(const GoalLimits& limits, Eigen::Index vertices, const std::string& owner);

/// Where the goals of a garment's vertices are in one step, at its start (t) and its end (t + dt):
/// what a skinned copy of the garment does. Parts of steps interpolate.
///
/// Whoever gives a garment limits gives it goals in each step. Each array is |V| x 3; normals may
/// be empty where no vertex has a backstop. Normals need not be of unit length; where one is zero,
/// there is no backstop.
struct SkinGoals {
    Points x0, x1;            ///< (m)
    Points normal0, normal1;  ///< outward

    /// Goals that rest at `x`.
    static SkinGoals at(const Points& x, const Points& normals = {}) {
        return {x, x, normals, normals};
    }
    bool empty() const { return x0.rows() == 0 && x1.rows() == 0; }
};

/// Whether these are goals for a garment of so many vertices with these limits: sizes fit, all
/// numbers are finite. Any are for one without limits.
bool are_goals_for(const GoalLimits& limits, const SkinGoals& goals, Eigen::Index vertices);

/// The limits of one vertex at one time. What is allowed is a ball around the goal without what
/// lies behind the backstop; it is convex, and the goal is always in it.
struct VertexGoal {
    int vertex;
    Vec3 place;           ///< the goal (m)
    Vec3 normal;          ///< of unit length, or zero: no backstop
    double max_distance;  ///< (m)
    double backstop;      ///< (m)

    /// How far `x` is outside of what is allowed (m): beyond the distance, or behind the backstop.
    double excess(const Vec3& x) const;
    /// `x` itself, or where it comes to from there: up to the backstop along the normal, then
    /// straight towards the goal.
    Vec3 within(const Vec3& x) const;
};

/// Those of all vertices that are limited and not pinned; none if `goals` do not fit.
/// @param progress  0: at t, 1: at t + dt
/// @param is_pinned  |V|
void take_goals(const GoalLimits& limits, const SkinGoals& goals,
                const std::vector<char>& is_pinned, double progress,
                std::vector<VertexGoal>& taken);

}  // namespace cloth
