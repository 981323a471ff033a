#pragma once

#include <memory>
#include <vector>

#include "bullet_ext/bodySegments.h"
#include "bullet_ext/bulletTypes.h"

class btCollisionShape;
class btRigidBody;
class btSoftRigidDynamicsWorld;

namespace cloth {

struct BulletClothSettings;

/// The obstacles of a Boundary as kinematic rigid bodies of a Bullet world.
class BulletHulls {
 public:
    BulletHulls();
    ~BulletHulls();

    /// Makes the bodies if the obstacles are others than in the last call, and takes their motion.
    void match(const std::vector<Obstacle>& obstacles, const std::vector<BodySegment>& segments,
               const BulletClothSettings& settings, btSoftRigidDynamicsWorld& world);

    /// Moves the bodies to the fraction s of the step, 0 at t and 1 at t + dt. A jump leaves no
    /// velocity behind: the next move starts from there.
    void moveTo(double s, bool jump = false);

    void removeFrom(btSoftRigidDynamicsWorld& world);

 private:
    struct Piece {
        std::unique_ptr<btCollisionShape> shape;
        std::unique_ptr<btRigidBody> body;
        size_t obstacle = 0;
        const BodySegment* segment = nullptr;  ///< null: a primitive
        Pose local = Pose::Identity();  ///< frame of the shape in the rest pose or the obstacle's
        Pose pose0, pose1;              ///< of the shape at t and t + dt
    };
    /// What tells one obstacle from another.
    struct Key {
        ObstacleShape shape;
        std::shared_ptr<const Faces> faces;
        Vec3 half_extents;
        double radius;
        bool operator==(const Key& o) const {
            return shape == o.shape && faces == o.faces && half_extents == o.half_extents &&
                   radius == o.radius;
        }
    };

    void build(const std::vector<Obstacle>& obstacles, const std::vector<BodySegment>& segments,
               const BulletClothSettings& settings, btSoftRigidDynamicsWorld& world);
    void addPrimitive(const Obstacle& obstacle, size_t index, btSoftRigidDynamicsWorld& world);
    void addSegments(const std::vector<BodySegment>& segments, size_t index, double margin,
                     btSoftRigidDynamicsWorld& world);
    void addPiece(Piece piece, btSoftRigidDynamicsWorld& world);

    std::vector<Key> m_keys;
    std::vector<Piece> m_pieces;
    std::vector<std::vector<BodySegment>> m_own_segments;  ///< of meshes that came without
};

}  // namespace cloth
