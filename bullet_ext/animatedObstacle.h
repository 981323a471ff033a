#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// A mesh obstacle whose vertices the user moves, such as a skinned character.
struct AnimatedMesh {
    std::shared_ptr<const Faces> faces;  ///< (|F| x 3), the same pointer for life
    Points x0;                           ///< vertices now (|V| x 3, m, world frame)
    Points x1;                           ///< vertices after `duration` (|V| x 3, m, world frame)
    double duration = 0.0;               ///< from x0 to x1 (s); 0: one world step
    std::shared_ptr<const std::vector<std::uint8_t>> limbs = {};  ///< see Obstacle; or null
};

/// The motion of an animated mesh in the steps of a world.
///
/// It is continuous: a mesh whose x0 is not where the last world step ended goes from there to x1
/// in the given duration, and beyond as from x0 to x1. It jumps if it would have to go half a metre
/// (root mean square), if it has other faces, if it was in no world, or if cloth at it was put
/// where it is since. A mesh that is not given anew stands at x1.
class AnimatedObstacle {
 public:
    struct Box {
        Vec3 low = Vec3::Zero(), high = Vec3::Zero();
        bool overlaps(const Vec3& other_low, const Vec3& other_high) const;
    };

    /// Replaces what was given before, whether a step has used it or not. Faces and limbs with the
    /// contents of those before keep their pointers, by which ObstacleTrees knows a mesh.
    void give(AnimatedMesh mesh, bool is_in_world);

    /// Starts a world step of h seconds.
    /// @param placed  boxes (m) of cloth that was put where it is since the last one
    void beginStep(double h, bool is_in_world, const std::vector<Box>& placed);

    const AnimatedMesh& mesh() const { return m_mesh; }
    /// Vertices at a time (s) counted from the start of the present world step.
    Points at(double time) const { return pose(m_begin + time); }
    /// Whether it moves in the present world step. A mesh that is given anew where it stands does
    /// not.
    bool moves() const { return m_moves && !m_stands; }
    /// Whether its object was in the world and is not.
    bool hasLeft(bool is_in_world) const { return m_was_in_world && !is_in_world; }
    bool isNear(const Vec3& low, const Vec3& high) const;
    /// Whether it was in the box (m) at the end of the last world step, and jumped from there.
    bool jumpsFrom(const Vec3& low, const Vec3& high) const;

    /// What is wrong with what was given, with a remedy, since the last call.
    std::vector<std::string> takeTroubles();

 private:
    void keepPointers(AnimatedMesh& mesh);
    void checkOrientation(const AnimatedMesh& mesh);
    void rememberPose();
    void start(double h, bool follows);
    void arrive(double h);
    Points pose(double time) const;

    AnimatedMesh m_mesh;
    double m_begin = 0.0, m_end = 0.0;  ///< the present world step, counted from x0 (s)
    Points m_last;                      ///< where it was at the end of the last world step (m) when
                                        ///< it was given anew, or stopped beyond x1; or nothing
    std::shared_ptr<const Faces> m_last_faces;
    bool m_from_last = false;          ///< it starts at m_last, not at x0
    bool m_stands = false;             ///< at x1
    bool m_moves = true;               ///< until it stands
    bool m_was_in_world = false;       ///< its object was, at some time
    bool m_acts = false;               ///< it was an obstacle in the last world step
    Box m_box0, m_box1;                ///< around start and end: all cloth asks for them
    std::optional<Box> m_jumped_from;  ///< around where it was, if it jumps in this world step
    int m_changes = 0;                 ///< in a row, of what its faces and limbs are
    int m_short_durations = 0;         ///< in a row
    bool m_told_of_orientation = false;
    std::vector<std::string> m_troubles;
};

}  // namespace cloth
