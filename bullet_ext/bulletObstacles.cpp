#include "bullet_ext/bulletObstacles.h"

#include <BulletSoftBody/btSoftBody.h>
#include <LinearMath/btTransformUtil.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "bullet_ext/shapeSignature.h"
#include "collision/proximity/obstacle_trees.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

bool canMove(const btCollisionObject& object) {
    return object.isKinematicObject() || !object.isStaticObject();
}

bool isInWorld(const btCollisionObject& object) {
    return object.getBroadphaseHandle() != nullptr;
}

std::string nameOf(const char* kind, const btCollisionObject& object) {
    std::ostringstream name;
    name << kind << ' ' << object.getUserIndex() << " at " << static_cast<const void*>(&object);
    return name.str();
}

/// Where the object was h seconds ago, by its velocity.
Pose posePreviously(const btCollisionObject& object, double h) {
    btTransform previous = object.getWorldTransform();
    if (canMove(object))
        btTransformUtil::integrateTransform(
            object.getWorldTransform(), -object.getInterpolationLinearVelocity(),
            -object.getInterpolationAngularVelocity(), static_cast<btScalar>(h), previous);
    return toPose(previous);
}

/// How long the object's own velocity takes from one transform to the next, in whole steps of h.
double travelTime(const btCollisionObject& object, const btTransform& from, double h) {
    if (!object.isKinematicObject()) return h;
    const btTransform& to = object.getWorldTransform();
    const double distance = (to.getOrigin() - from.getOrigin()).length();
    const double speed = object.getInterpolationLinearVelocity().length();
    const double angle = from.getRotation().angleShortestPath(to.getRotation());
    const double turn_rate = object.getInterpolationAngularVelocity().length();
    double time = h;
    if (distance > 1e-6 && speed > 0.0)
        time = distance / speed;
    else if (angle > 1e-3 && turn_rate > 0.0)
        time = angle / turn_rate;
    constexpr double kMaxSteps = 64;  // slower than that, the velocity is not about this move
    const double steps = std::round(time / h);
    return steps >= 1.0 && steps <= kMaxSteps ? steps * h : h;
}

bool isPushable(const btCollisionObject* object) {
    const btRigidBody* rigid = btRigidBody::upcast(object);
    return rigid && !rigid->isStaticOrKinematicObject() && rigid->getInvMass() > 0;
}

struct ProxyCollector : btBroadphaseAabbCallback {
    std::vector<const btCollisionObject*> objects;
    bool process(const btBroadphaseProxy* proxy) override {
        objects.push_back(static_cast<const btCollisionObject*>(proxy->m_clientObject));
        return true;
    }
};

/// Numbers that tell two obstacles apart, whatever their addresses.
std::vector<double> sortingKey(const Obstacle& o) {
    std::vector<double> key = {static_cast<double>(o.shape), o.radius, o.friction};
    for (int i = 0; i < 3; ++i) key.push_back(o.half_extents[i]);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 3; ++r) key.push_back(o.pose1.matrix()(r, c));
    if (!o.faces) return key;
    key.push_back(static_cast<double>(o.faces->rows()));
    for (int i = 0; i < 3; ++i) key.push_back(o.x1(o.x1.rows() / 2, i));
    return key;
}

void sortByGeometry(std::vector<Obstacle>& obstacles,
                    std::vector<const btCollisionObject*>& owners) {
    std::vector<std::pair<std::vector<double>, size_t>> order;
    for (size_t i = 0; i < obstacles.size(); ++i) order.emplace_back(sortingKey(obstacles[i]), i);
    std::sort(order.begin(), order.end());
    std::vector<Obstacle> sorted;
    std::vector<const btCollisionObject*> their;
    for (const auto& entry : order) {
        sorted.push_back(std::move(obstacles[entry.second]));
        their.push_back(owners[entry.second]);
    }
    obstacles = std::move(sorted);
    owners = std::move(their);
}

}  // namespace

BulletObstacles::BulletObstacles() : m_trees(std::make_shared<ObstacleTrees>()) {
}

void BulletObstacles::beginStep(double h) {
    m_h = h;
    ++m_step;
    m_trees->begin_step();
    for (auto& [object, animated] : m_animated) {
        animated.obstacle.beginStep(h, isInWorld(*object), m_placed);
        for (const std::string& trouble : animated.obstacle.takeTroubles())
            m_messages.push_back(nameOf("animated obstacle", *object) + ": " + trouble);
    }
    m_placed.clear();
    forgetUnseen();
}

void BulletObstacles::forgetUnseen() {
    constexpr long kSteps = 1000;
    for (auto it = m_tracks.begin(); it != m_tracks.end();)
        it = it->second.step < m_step - kSteps ? m_tracks.erase(it) : std::next(it);
}

void BulletObstacles::setAnimated(const btCollisionObject* object, AnimatedMesh mesh) {
    if (!object || !mesh.faces || mesh.faces->rows() == 0 || mesh.x0.rows() == 0 ||
        mesh.x0.rows() != mesh.x1.rows())
        throw ArgumentError("animated obstacle",
                            "has no object, no faces, or x0 and x1 differ in "
                            "size",
                            "give the same number of vertices at both times");
    if (mesh.faces->minCoeff() < 0 || mesh.faces->maxCoeff() >= mesh.x0.rows())
        throw ArgumentError("animated obstacle", "a face refers to a vertex that does not exist",
                            "number vertices from 0 to |V| - 1");
    if (mesh.limbs && !are_limbs_of(*mesh.faces, *mesh.limbs))
        throw ArgumentError("animated obstacle",
                            "has not one limb from 0 to 31 for each of its " +
                                std::to_string(mesh.faces->rows()) + " faces",
                            "number the limb of each face, or leave limbs away");
    if (!mesh.x0.allFinite() || !mesh.x1.allFinite() || !(mesh.duration >= 0.0) ||
        std::isinf(mesh.duration))
        throw ArgumentError("animated obstacle", "vertices or duration are not finite",
                            "check the animation before handing it over");
    const auto [known, is_new] = m_animated.try_emplace(object);
    if (is_new) known->second.id = ++m_ids;
    known->second.obstacle.give(std::move(mesh), isInWorld(*object));
}

bool BulletObstacles::collides(const btSoftBody& body, const btCollisionObject& object) const {
    if (object.getInternalType() == btCollisionObject::CO_SOFT_BODY) return false;
    if (!(body.m_cfg.collisions & btSoftBody::fCollision::RVSmask)) return false;
    if (!object.hasContactResponse() || !isFinite(object.getWorldTransform())) return false;
    const btBroadphaseProxy* a = body.getBroadphaseHandle();
    const btBroadphaseProxy* b = object.getBroadphaseHandle();
    if (a && b &&
        !((a->m_collisionFilterGroup & b->m_collisionFilterMask) &&
          (b->m_collisionFilterGroup & a->m_collisionFilterMask)))
        return false;
    if (!body.checkCollideWith(&object) || !object.checkCollideWith(&body)) return false;
    const auto& disabled = body.m_collisionDisabledObjects;
    return disabled.findLinearSearch(&object) == disabled.size();
}

/// An animation whose object has left the world has left it, too.
bool BulletObstacles::touches(const btSoftBody& body, const btCollisionObject& object,
                              const AnimatedObstacle& animated, const Vec3& low,
                              const Vec3& high) const {
    return !animated.hasLeft(isInWorld(object)) && collides(body, object) &&
           animated.isNear(low, high);
}

double BulletObstacles::frictionOf(const btSoftBody& body, const btCollisionObject& object) {
    if (!(object.getFriction() >= 0))
        m_messages.push_back(
            nameOf("collision object", object) +
            ": its friction is negative or no number, and counts as 0 for cloth. Remedy: "
            "check what the program gives to setFriction()");
    return std::min(usableFriction(body.m_cfg.kDF) * usableFriction(object.getFriction()),
                    kMostFriction);
}

void BulletObstacles::refreshParts(Track& track, const btCollisionObject& object) {
    const btCollisionShape& shape = *object.getCollisionShape();
    const size_t signature = shapeSignature(shape);
    if (track.step >= 0 && signature == track.signature) return;
    track.signature = signature;
    track.parts = partsOfShape(shape);
    track.distances.clear();
    if (track.parts.empty() && shape.getShapeType() != EMPTY_SHAPE_PROXYTYPE)
        m_messages.push_back(std::string("collision shape ") + shape.getName() +
                             " has no surface that cloth could touch: it is passed through. "
                             "Remedy: use a primitive, a convex hull or a triangle mesh");
}

BulletObstacles::Track& BulletObstacles::update(const btCollisionObject& object) {
    Track& track = m_tracks[&object];
    if (track.step == m_step) return track;
    const int world_id = worldIdOf(object);
    const bool came_back = track.world_id != 0 && track.world_id != world_id;
    if (came_back) track.step = -1;  // nothing of it holds any more
    track.world_id = world_id;
    refreshParts(track, object);
    const btTransform& target = object.getWorldTransform();
    if (track.step != m_step - 1 || !canMove(object)) {
        // The way of a kinematic body that came back is a velocity to Bullet.
        const bool placed = came_back && object.isKinematicObject();
        track.begin = placed ? toPose(target) : posePreviously(object, m_h);
        track.end = toPose(target);
        track.remaining = 0.0;
    } else {
        if (!(target == track.target)) track.remaining = travelTime(object, track.target, m_h);
        track.begin = track.end;
        const bool arrives = track.remaining <= 1.001 * m_h;
        track.end = arrives ? toPose(target)
                            : interpolate(track.begin, toPose(target), m_h / track.remaining);
        track.remaining = arrives ? 0.0 : track.remaining - m_h;
    }
    track.target = target;
    track.step = m_step;
    return track;
}

void BulletObstacles::follow(const btCollisionObject& object) {
    const auto found = m_tracks.find(&object);
    if (found == m_tracks.end()) return;
    found->second.target = object.getWorldTransform();
    found->second.end = toPose(found->second.target);
    found->second.remaining = 0.0;
}

void BulletObstacles::append(const Track& track, double friction, const TimeSpan& span,
                             std::vector<Obstacle>& obstacles) const {
    const Pose pose0 = interpolate(track.begin, track.end, span.begin / m_h);
    const Pose pose1 = interpolate(track.begin, track.end, (span.begin + span.length) / m_h);
    for (const ShapePart& part : track.parts) {
        Obstacle obstacle;
        obstacle.shape = part.shape;
        obstacle.half_extents = part.half_extents;
        obstacle.radius = part.radius;
        obstacle.friction = friction;
        if (part.shape == ObstacleShape::mesh) {
            obstacle.faces = part.faces;
            obstacle.x0 = transformed(part.vertices, pose0);
            obstacle.x1 = transformed(part.vertices, pose1);
        } else {
            obstacle.pose0 = pose0 * part.frame;
            obstacle.pose1 = pose1 * part.frame;
        }
        obstacles.push_back(std::move(obstacle));
    }
}

void BulletObstacles::append(const Animated& animated, double friction, const TimeSpan& span,
                             std::vector<Obstacle>& obstacles) const {
    Obstacle obstacle;
    obstacle.faces = animated.obstacle.mesh().faces;
    obstacle.limbs = animated.obstacle.mesh().limbs;
    obstacle.id = animated.id;
    obstacle.x0 = animated.obstacle.at(span.begin);
    obstacle.x1 = animated.obstacle.at(span.begin + span.length);
    obstacle.friction = friction;
    obstacles.push_back(std::move(obstacle));
}

std::vector<const btCollisionObject*> BulletObstacles::objectsIn(const btSoftBody& body,
                                                                 const Vec3& low,
                                                                 const Vec3& high) const {
    ProxyCollector found;
    if (body.m_worldInfo->m_broadphase)
        body.m_worldInfo->m_broadphase->aabbTest(toBullet(low), toBullet(high), found);
    std::vector<const btCollisionObject*> objects;
    for (const btCollisionObject* object : found.objects)
        if (!m_animated.count(object) && collides(body, *object)) objects.push_back(object);
    return objects;
}

void BulletObstacles::watch(const btSoftBody& body, const Vec3& low, const Vec3& high) {
    for (const btCollisionObject* object : objectsIn(body, low, high)) update(*object);
}

std::vector<Obstacle> BulletObstacles::near(const btSoftBody& body, const Vec3& low,
                                            const Vec3& high, const TimeSpan& span,
                                            std::vector<const btCollisionObject*>* owners) {
    std::vector<Obstacle> obstacles;
    std::vector<const btCollisionObject*> objects;
    for (const btCollisionObject* object : objectsIn(body, low, high)) {
        append(update(*object), frictionOf(body, *object), span, obstacles);
        objects.resize(obstacles.size(), object);
    }
    for (const auto& [object, animated] : m_animated)
        if (touches(body, *object, animated.obstacle, low, high)) {
            append(animated, frictionOf(body, *object), span, obstacles);
            objects.resize(obstacles.size(), object);
        }
    sortByGeometry(obstacles, objects);
    if (owners) *owners = std::move(objects);
    return obstacles;
}

bool BulletObstacles::anyJumpsFrom(const Vec3& low, const Vec3& high) const {
    return std::any_of(m_animated.begin(), m_animated.end(), [&](const auto& known) {
        return known.second.obstacle.jumpsFrom(low, high);
    });
}

std::vector<NearObject> BulletObstacles::objectsNear(const btSoftBody& body, const Vec3& low,
                                                     const Vec3& high) const {
    std::vector<NearObject> near;
    for (const btCollisionObject* object : objectsIn(body, low, high))
        near.push_back({object, worldIdOf(*object), object->getWorldTransform(),
                        shapeSignature(*object->getCollisionShape()), false, false});
    for (const auto& [object, animated] : m_animated)
        if (touches(body, *object, animated.obstacle, low, high))
            near.push_back({object, worldIdOf(*object), object->getWorldTransform(), 0,
                            animated.obstacle.moves(), true});
    std::sort(near.begin(), near.end(), [](const NearObject& a, const NearObject& b) {
        return std::less<const btCollisionObject*>()(a.object, b.object);
    });
    return near;
}

std::vector<NearSolid> BulletObstacles::solidsNear(const btSoftBody& body, const Vec3& low,
                                                   const Vec3& high, const TimeSpan& span) {
    const auto moves = [](const btCollisionObject* object) {
        return isPushable(object) || object->isKinematicObject() || isLink(*object);
    };
    const std::vector<const btCollisionObject*> objects = objectsIn(body, low, high);
    const bool closing = objects.size() > 1 && std::any_of(objects.begin(), objects.end(), moves);
    std::vector<NearSolid> solids;
    if (!closing && body.m_anchors.size() == 0 &&
        std::none_of(objects.begin(), objects.end(), isPushable))
        return solids;
    for (const btCollisionObject* object : objects) {
        Track& track = update(*object);
        // The world owns the body and may push it; cloth only hands on what the world would do.
        btRigidBody* pushed =
            isPushable(object) ? const_cast<btRigidBody*>(btRigidBody::upcast(object)) : nullptr;
        const auto inverseAt = [&](double time) {
            return interpolate(track.begin, track.end, time / m_h).inverse();
        };
        solids.push_back({object, pushed, inverseAt(span.begin + span.length),
                          inverseAt(span.begin), &distancesOf(track)});
    }
    return solids;
}

bool BulletObstacles::anyDynamicNear(const btSoftBody& body, const Vec3& low,
                                     const Vec3& high) const {
    const std::vector<const btCollisionObject*> objects = objectsIn(body, low, high);
    return std::any_of(objects.begin(), objects.end(), isPushable);
}

const std::vector<PartDistance>& BulletObstacles::distancesOf(Track& track) const {
    if (track.distances.empty())
        for (const ShapePart& part : track.parts) track.distances.emplace_back(part);
    return track.distances;
}

double BulletObstacles::deepest(const btSoftBody& body, const Points& x,
                                const std::vector<char>& left_out) {
    constexpr double kDeepest = 0.1;  // m
    double depth = 0.0;
    const Vec3 low = x.colwise().minCoeff(), high = x.colwise().maxCoeff();
    for (const btCollisionObject* object : objectsIn(body, low, high)) {
        Track& track = update(*object);
        const Pose inverse = track.end.inverse();
        for (const PartDistance& part : distancesOf(track))
            for (Eigen::Index i = 0; i < x.rows(); ++i)
                if (!left_out[static_cast<size_t>(i)])
                    depth = std::max(
                        depth, -part.at(inverse * x.row(i).transpose(), kDeepest).value_or(0.0));
    }
    return depth;
}

NearSolid NearSolid::before() const {
    NearSolid solid = *this;
    solid.inverse = inverse_before;
    return solid;
}

Vec3 NearSolid::velocity(const Vec3& point, double length) const {
    if (body)
        return toVec3(body->getVelocityInLocalPoint(
            toBullet(Vec3(point - toVec3(body->getCenterOfMassPosition())))));
    return (point - motion().inverse() * point) / length;
}

void NearSolid::shift(const Vec3& before_shift, const Vec3& now) {
    inverse = inverse * Eigen::Translation3d(-now);
    inverse_before = inverse_before * Eigen::Translation3d(-before_shift);
}

std::vector<SlidingSolid> BulletObstacles::slidingNear(const btSoftBody& body, const Vec3& low,
                                                       const Vec3& high, double time) {
    std::vector<SlidingSolid> solids;
    for (const btCollisionObject* object : objectsIn(body, low, high)) {
        Track& track = update(*object);
        SlidingSolid sliding;
        sliding.near.object = object;
        const btRigidBody* rigid = btRigidBody::upcast(object);
        // The world owns the body and may push it; friction does what the world would do.
        if (rigid && !rigid->isStaticOrKinematicObject() && rigid->getInvMass() > 0)
            sliding.near.body = const_cast<btRigidBody*>(rigid);
        sliding.near.inverse = interpolate(track.begin, track.end, time / m_h).inverse();
        sliding.near.parts = &distancesOf(track);
        sliding.friction = usableFriction(object->getFriction());
        sliding.motion = track.end * track.begin.inverse();
        sliding.duration = m_h;
        solids.push_back(sliding);
    }
    return solids;
}

Vec3 SlidingSolid::velocity(const Vec3& point) const {
    if (!near.body) return (point - motion.inverse() * point) / duration;
    const Vec3 arm = point - toVec3(near.body->getCenterOfMassPosition());
    return toVec3(near.body->getVelocityInLocalPoint(toBullet(arm)));
}

std::optional<double> NearSolid::distance(const Vec3& point, double radius) const {
    const Vec3 local = inverse * point;
    std::optional<double> nearest;
    for (const PartDistance& part : *parts) {
        const std::optional<double> here = part.at(local, radius);
        if (here && (!nearest || *here < *nearest)) nearest = here;
    }
    return nearest;
}

Vec3 NearSolid::outward(const Vec3& point, double radius) const {
    constexpr double kStep = 1e-5;  // m
    Vec3 gradient;
    for (int c = 0; c < 3; ++c) {
        const Vec3 step = kStep * Vec3::Unit(c);
        const std::optional<double> ahead = distance(point + step, radius + kStep);
        const std::optional<double> behind = distance(point - step, radius + kStep);
        if (!ahead || !behind) return Vec3::Zero();
        gradient[c] = *ahead - *behind;
    }
    return gradient.stableNormalized();
}

std::vector<std::string> BulletObstacles::takeMessages() {
    return std::exchange(m_messages, {});
}

}  // namespace cloth
