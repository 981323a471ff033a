#include "bullet_ext/bulletHulls.h"

#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <Eigen/SVD>

#include "bullet_ext/bulletClothStepper.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr double kPlaneSize = 50.0;  ///< half the width of the box that stands for a plane (m)

/// The rigid motion that takes `from` to `to` (each |V| x 3) with the least squared error: Kabsch
/// 1976, "A solution for the best rotation to relate two sets of vectors".
Pose rigidFit(const Points& from, const Points& to) {
    const Eigen::RowVector3d from_mean = from.colwise().mean(), to_mean = to.colwise().mean();
    const Eigen::Matrix3d covariance =
        (to.rowwise() - to_mean).transpose() * (from.rowwise() - from_mean);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0.0) u.col(2) = -u.col(2);
    Pose pose = Pose::Identity();
    pose.linear() = u * svd.matrixV().transpose();
    pose.translation() = to_mean.transpose() - pose.linear() * from_mean.transpose();
    return pose;
}

bool belongTo(const std::vector<BodySegment>& segments, const Obstacle& obstacle) {
    for (const BodySegment& segment : segments)
        if (!segment.vertices.empty() && segment.vertices.back() >= obstacle.x0.rows())
            return false;
    return !segments.empty();
}

std::unique_ptr<btCollisionShape> primitiveShape(const Obstacle& o) {
    const auto radius = static_cast<btScalar>(o.radius);
    switch (o.shape) {
        case ObstacleShape::sphere:
            return std::make_unique<btSphereShape>(radius);
        case ObstacleShape::capsule:
            return std::make_unique<btCapsuleShape>(radius,
                                                    static_cast<btScalar>(2 * o.half_extents.y()));
        case ObstacleShape::box: {
            auto box = std::make_unique<btBoxShape>(
                toBullet(Vec3(o.half_extents + Vec3::Constant(o.radius))));
            box->setMargin(radius);  // Bullet rounds a box by its margin
            return box;
        }
        default: {
            const btScalar half = static_cast<btScalar>(kPlaneSize);
            auto box = std::make_unique<btBoxShape>(btVector3(half, half, half));
            box->setMargin(0);
            return box;
        }
    }
}

}  // namespace

BulletHulls::BulletHulls() = default;
BulletHulls::~BulletHulls() = default;

void BulletHulls::match(const std::vector<Obstacle>& obstacles,
                        const std::vector<BodySegment>& segments,
                        const BulletClothSettings& settings, btSoftRigidDynamicsWorld& world) {
    std::vector<Key> keys;
    for (const Obstacle& o : obstacles)
        keys.push_back({o.shape, o.faces, o.half_extents, o.radius});
    if (!(keys == m_keys)) {
        removeFrom(world);
        build(obstacles, segments, settings, world);
        m_keys = std::move(keys);
    }
    for (Piece& piece : m_pieces) {
        const Obstacle& o = obstacles[piece.obstacle];
        piece.body->setFriction(static_cast<btScalar>(o.friction));
        const Pose pose0 =
            piece.segment ? rigidFit(piece.segment->rest, o.x0(piece.segment->vertices, Eigen::all))
                          : o.pose0;
        const Pose pose1 =
            piece.segment ? rigidFit(piece.segment->rest, o.x1(piece.segment->vertices, Eigen::all))
                          : o.pose1;
        piece.pose0 = pose0 * piece.local;
        piece.pose1 = pose1 * piece.local;
    }
}

void BulletHulls::build(const std::vector<Obstacle>& obstacles,
                        const std::vector<BodySegment>& segments,
                        const BulletClothSettings& settings, btSoftRigidDynamicsWorld& world) {
    bool given = false;
    m_own_segments.reserve(obstacles.size());  // pieces point into it
    for (size_t i = 0; i < obstacles.size(); ++i) {
        const Obstacle& o = obstacles[i];
        if (o.shape != ObstacleShape::mesh) {
            addPrimitive(o, i, world);
        } else if (!given && belongTo(segments, o)) {
            given = true;
            addSegments(segments, i, settings.hull_margin, world);
        } else if (o.faces) {
            try {
                m_own_segments.push_back(segment_body(
                    {o.x0, *o.faces}, std::vector<int>(static_cast<size_t>(o.x0.rows()), 0),
                    settings.segments));
                addSegments(m_own_segments.back(), i, settings.hull_margin, world);
            } catch (const ArgumentError&) {
                // A mesh without a usable surface stops nothing here, as in every other stepper.
            }
        }
    }
}

void BulletHulls::addPrimitive(const Obstacle& obstacle, size_t index,
                               btSoftRigidDynamicsWorld& world) {
    Piece piece;
    piece.shape = primitiveShape(obstacle);
    piece.obstacle = index;
    if (obstacle.shape == ObstacleShape::plane) piece.local.translation() = Vec3(0, -kPlaneSize, 0);
    addPiece(std::move(piece), world);
}

void BulletHulls::addSegments(const std::vector<BodySegment>& segments, size_t index, double margin,
                              btSoftRigidDynamicsWorld& world) {
    for (const BodySegment& segment : segments) {
        auto hull = std::make_unique<btConvexHullShape>();
        // Bullet's distance fields are floats around the shape's origin: put it in the middle.
        const Vec3 centre = segment.hull_points_rest.colwise().mean();
        for (Eigen::Index i = 0; i < segment.hull_points_rest.rows(); ++i)
            hull->addPoint(toBullet(Vec3(segment.hull_points_rest.row(i).transpose() - centre)),
                           false);
        hull->recalcLocalAabb();
        hull->setMargin(static_cast<btScalar>(margin));
        Piece piece;
        piece.shape = std::move(hull);
        piece.obstacle = index;
        piece.segment = &segment;
        piece.local.translation() = centre;
        addPiece(std::move(piece), world);
    }
}

void BulletHulls::addPiece(Piece piece, btSoftRigidDynamicsWorld& world) {
    piece.body = std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0, nullptr, piece.shape.get()));
    piece.body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    piece.body->setActivationState(DISABLE_DEACTIVATION);
    piece.body->setUserIndex(static_cast<int>(m_pieces.size()));
    // Hulls of one body overlap: they meet cloth only.
    world.addRigidBody(piece.body.get(), btBroadphaseProxy::KinematicFilter,
                       btBroadphaseProxy::DefaultFilter);
    m_pieces.push_back(std::move(piece));
}

void BulletHulls::moveTo(double s, bool jump) {
    for (Piece& piece : m_pieces) {
        const btTransform transform = toBullet(interpolate(piece.pose0, piece.pose1, s));
        piece.body->setWorldTransform(transform);
        if (jump) piece.body->setInterpolationWorldTransform(transform);
    }
}

void BulletHulls::removeFrom(btSoftRigidDynamicsWorld& world) {
    for (Piece& piece : m_pieces) {
        world.removeRigidBody(piece.body.get());
        world.getWorldInfo().m_sparsesdf.RemoveReferences(piece.shape.get());
    }
    m_pieces.clear();
    m_own_segments.clear();
    m_keys.clear();
}

}  // namespace cloth
