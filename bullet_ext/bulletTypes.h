#pragma once

#ifdef BT_USE_DOUBLE_PRECISION
#error \
    "FastCloth is built against Bullet in single precision: compile without \
BT_USE_DOUBLE_PRECISION and link bullet.pc (Debian), not bullet-float64.pc"
#endif

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btTransform.h>

#include <algorithm>

#include "data/core/boundary.h"

namespace cloth {

inline Vec3 toVec3(const btVector3& v) {
    return {v.x(), v.y(), v.z()};
}

inline btVector3 toBullet(const Vec3& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()),
            static_cast<btScalar>(v.z())};
}

inline Eigen::Matrix3d toMatrix(const btMatrix3x3& m) {
    Eigen::Matrix3d matrix;
    for (int r = 0; r < 3; ++r) matrix.row(r) = toVec3(m[r]);
    return matrix;
}

/// Whether it is a part of a btMultiBody.
inline bool isLink(const btCollisionObject& object) {
    return object.getInternalType() == btCollisionObject::CO_FEATHERSTONE_LINK;
}

/// A number that an object gets when it is added to a world; 0 if it is in none. Bullet's
/// btDbvtBroadphase never gives one twice; those of btAxisSweep3 may come again.
inline int worldIdOf(const btCollisionObject& object) {
    const btBroadphaseProxy* proxy = object.getBroadphaseHandle();
    return proxy ? proxy->getUid() : 0;
}

/// Holds cloth on all slopes below 89.4 degrees. Much larger ones are no numbers for solvers.
constexpr double kMostFriction = 100.0;

/// A user's friction, or kDF, as steppers can take it: 0 if it is negative or no number, and
/// kMostFriction at most.
inline double usableFriction(btScalar friction) {
    return friction > 0 ? std::min(static_cast<double>(friction), kMostFriction) : 0.0;
}

inline bool isFinite(const btVector3& v) {
    return toVec3(v).allFinite();
}

inline bool isFinite(const btTransform& pose) {
    return isFinite(pose.getOrigin()) && toMatrix(pose.getBasis()).allFinite();
}

/// Whether a finite pose only turns and moves.
inline bool isRigid(const btTransform& pose) {
    constexpr double kFar = 1e-3;
    const Eigen::Matrix3d basis = toMatrix(pose.getBasis());
    return (basis * basis.transpose()).isApprox(Eigen::Matrix3d::Identity(), kFar) &&
           basis.determinant() > 0.0;
}

/// Whether Bullet's floats can hold the numbers (m, m/s, N s) and their squares.
template <typename Derived>
bool fitsFloats(const Eigen::MatrixBase<Derived>& numbers) {
    constexpr double most = 1e15;
    return numbers.allFinite() && (numbers.size() == 0 || numbers.cwiseAbs().maxCoeff() < most);
}

/// crossMatrix(r) * v is r x v.
inline Eigen::Matrix3d crossMatrix(const Vec3& r) {
    Eigen::Matrix3d matrix;
    matrix << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
    return matrix;
}

/// Bullet's frame in doubles, its rotation made orthonormal again.
inline Pose toPose(const btTransform& t) {
    const btQuaternion q = t.getRotation();
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
    pose.translation() = toVec3(t.getOrigin());
    return pose;
}

inline btTransform toBullet(const Pose& pose) {
    const Eigen::Quaterniond q(pose.linear());
    return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                    static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                       toBullet(Vec3(pose.translation())));
}

}  // namespace cloth
