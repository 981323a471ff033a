#pragma once

#include <LinearMath/btTransform.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bullet_ext/animatedObstacle.h"
#include "bullet_ext/bulletShapes.h"
#include "bullet_ext/partDistance.h"

class btCollisionObject;
class btRigidBody;
class btSoftBody;

namespace cloth {

/// A part of the time axis, counted from the start of the present world step (s).
struct TimeSpan {
    double begin = 0.0;
    double length = 0.0;
};

/// A solid as it is at the end of a span of time.
struct NearSolid {
    const btCollisionObject* object = nullptr;
    btRigidBody* body = nullptr;                       ///< that cloth can push; null: nothing can
    Pose inverse = Pose::Identity();                   ///< from the world to the body
    Pose inverse_before = Pose::Identity();            ///< the same at the start of the span
    const std::vector<PartDistance>* parts = nullptr;  ///< of the shape; valid in this world step

    /// The solid at the start of the span.
    NearSolid before() const;
    /// Takes a point of the world along, from the start of the span to its end.
    Pose motion() const { return inverse.inverse() * inverse_before; }
    /// Velocity of the surface at a point of the world, at the end of a span of that length (s):
    /// that of the body, or of the motion.
    Vec3 velocity(const Vec3& point, double length) const;
    /// Moves the solid (m): at the start, and at the end.
    void shift(const Vec3& before, const Vec3& now);

    /// Signed distance (m) of a point of the world; none if it is farther than `radius`.
    std::optional<double> distance(const Vec3& point, double radius) const;
    /// Direction away from the solid at a point within `radius` of it (unit vector, or zero).
    Vec3 outward(const Vec3& point, double radius) const;
};

/// A solid that cloth slides on.
struct SlidingSolid {
    NearSolid near;
    double friction = 0.0;           ///< of the object, see usableFriction()
    Pose motion = Pose::Identity();  ///< takes it from where it was one world step ago to now
    double duration = 1.0;           ///< of the world step (s)

    /// Of its surface at a point of the world (m/s).
    Vec3 velocity(const Vec3& point) const;
};

/// What sleeping cloth has to know of an object near it.
struct NearObject {
    const btCollisionObject* object = nullptr;
    int world_id = 0;  ///< worldIdOf()
    btTransform pose;
    size_t shape = 0;    ///< shapeSignature()
    bool moves = false;  ///< an animated mesh under way, see AnimatedObstacle::moves()
    bool is_animated = false;
};

/// Watches the collision objects of a Bullet world and describes them as obstacles.
///
/// Bullet gives poses at the end of a step only, and those of kinematic bodies once for all
/// sub-steps of a stepSimulation(). So the pose of every object near cloth is remembered, a
/// kinematic body's jump is spread over the time that its velocity says it takes, and times beyond
/// the present step are extrapolated with the velocity of the step. Static objects that are
/// elsewhere were put there, as was an object that left the world and came back: they jump.
class BulletObstacles {
 public:
    BulletObstacles();

    /// Starts a world step of h seconds.
    void beginStep(double h);

    /// Follows the objects that may touch `body` in the box [low, high] (m). Due in every world
    /// step, so that their motion is known when near() is asked.
    void watch(const btSoftBody& body, const Vec3& low, const Vec3& high);

    /// Obstacles that may touch `body` within the box [low, high] during `span`: static, kinematic
    /// and dynamic objects that pass Bullet's collision filters. Their order depends on their
    /// geometry only, not on the order in which they were added.
    /// @param owners  if not null: the object of each obstacle
    std::vector<Obstacle> near(const btSoftBody& body, const Vec3& low, const Vec3& high,
                               const TimeSpan& span,
                               std::vector<const btCollisionObject*>* owners = nullptr);

    /// The objects among them that are not animated meshes, during `span`; none where all of them
    /// are static, or one alone is kinematic, and `body` has no anchors.
    std::vector<NearSolid> solidsNear(const btSoftBody& body, const Vec3& low, const Vec3& high,
                                      const TimeSpan& span);

    /// Whether there is an object among them that cloth can push.
    bool anyDynamicNear(const btSoftBody& body, const Vec3& low, const Vec3& high) const;

    /// How deep the deepest of the points `x` (|V| x 3, m) is in an object that is not an animated
    /// mesh, at the end of the world step (m). What is deeper in a mesh than 0.1 m is not seen.
    /// @param left_out  points that do not count (|V|)
    double deepest(const btSoftBody& body, const Points& x, const std::vector<char>& left_out);

    /// The objects of solidsNear(), whatever they are, with what friction asks for.
    std::vector<SlidingSolid> slidingNear(const btSoftBody& body, const Vec3& low, const Vec3& high,
                                          double time);

    /// All objects that near() would look at, in a fixed order.
    std::vector<NearObject> objectsNear(const btSoftBody& body, const Vec3& low,
                                        const Vec3& high) const;

    /// Hierarchies of the mesh obstacles, for the Boundary of every garment in the world.
    const std::shared_ptr<ObstacleTrees>& trees() const { return m_trees; }

    void setAnimated(const btCollisionObject* object, AnimatedMesh mesh);
    void removeAnimated(const btCollisionObject* object) { m_animated.erase(object); }
    /// Cloth in the box (m) was put where it is: animated meshes there do not move through it from
    /// where they were at the end of the last world step.
    void clothWasPlaced(const Vec3& low, const Vec3& high) { m_placed.push_back({low, high}); }
    /// Whether an animated mesh was in the box (m) at the end of the last world step, and starts
    /// this one more than half a metre from there.
    bool anyJumpsFrom(const Vec3& low, const Vec3& high) const;

    /// The object was put elsewhere at the end of the world step.
    void follow(const btCollisionObject& object);

    /// Messages since the last call: shapes that cannot be obstacles, each reported once, frictions
    /// that are none, and what is wrong with animated meshes.
    std::vector<std::string> takeMessages();

 private:
    struct Track {
        int world_id = 0;  ///< of the object: another one may have its address later
        size_t signature = 0;
        std::vector<ShapePart> parts;
        std::vector<PartDistance> distances;  ///< of the parts; made when asked for
        long step = -1;                       ///< world step of the last update
        Pose begin, end;                      ///< at both ends of the present world step
        btTransform target;                   ///< where Bullet says the object is
        double remaining = 0.0;               ///< time left to reach the target (s)
    };
    struct Animated {
        AnimatedObstacle obstacle;
        int id = 0;  ///< Obstacle::id: one for each object, until it is removed
    };

    bool collides(const btSoftBody& body, const btCollisionObject& object) const;
    bool touches(const btSoftBody& body, const btCollisionObject& object,
                 const AnimatedObstacle& animated, const Vec3& low, const Vec3& high) const;
    double frictionOf(const btSoftBody& body, const btCollisionObject& object);
    std::vector<const btCollisionObject*> objectsIn(const btSoftBody& body, const Vec3& low,
                                                    const Vec3& high) const;
    Track& update(const btCollisionObject& object);
    const std::vector<PartDistance>& distancesOf(Track& track) const;
    void refreshParts(Track& track, const btCollisionObject& object);
    void forgetUnseen();
    void append(const Track& track, double friction, const TimeSpan& span,
                std::vector<Obstacle>& obstacles) const;
    void append(const Animated& animated, double friction, const TimeSpan& span,
                std::vector<Obstacle>& obstacles) const;

    double m_h = 0.0;
    long m_step = 0;
    std::shared_ptr<ObstacleTrees> m_trees;
    std::map<const btCollisionObject*, Track> m_tracks;
    std::map<const btCollisionObject*, Animated> m_animated;
    int m_ids = 0;                                ///< of animated meshes so far
    std::vector<AnimatedObstacle::Box> m_placed;  ///< cloth, since the last world step
    std::vector<std::string> m_messages;
};

}  // namespace cloth
