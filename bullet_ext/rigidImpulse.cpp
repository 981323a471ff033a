#include "bullet_ext/rigidImpulse.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace cloth {

bool isDynamic(const btRigidBody& body) {
    return body.getInvMass() > 0 && !body.isStaticOrKinematicObject();
}

Vec3 centreOf(const btRigidBody& body) {
    return toVec3(body.getCenterOfMassPosition());
}

Matrix6 massMatrix(const btRigidBody& body) {
    constexpr double kLeast = 1e-9;
    Matrix6 matrix = Matrix6::Zero();
    const double inverse = std::max(static_cast<double>(body.getInvMass()), kLeast);
    matrix.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / inverse;
    const Vec3 moments = toVec3(body.getInvInertiaDiagLocal()).cwiseMax(kLeast).cwiseInverse();
    const Eigen::Matrix3d turn = toMatrix(body.getCenterOfMassTransform().getBasis());
    matrix.bottomRightCorner<3, 3>() = turn * moments.asDiagonal() * turn.transpose();
    return matrix;
}

Vector6 solve(const Matrix6& mass, const Vector6& impulse) {
    return mass.ldlt().solve(impulse);
}

Vector6 motionOf(const btRigidBody& body) {
    Vector6 velocity;
    velocity.head<3>() = toVec3(body.getLinearVelocity());
    velocity.tail<3>() = toVec3(body.getAngularVelocity());
    return velocity;
}

Vec3 velocityOf(const btRigidBody& body, const Vec3& place) {
    return toVec3(body.getVelocityInLocalPoint(toBullet(Vec3(place - centreOf(body)))));
}

double kineticEnergy(const Matrix6& mass, const Vector6& motion) {
    return 0.5 * motion.dot(mass * motion);
}

double gainOf(const btRigidBody& body, const Vector6& impulse) {
    return impulse.dot(motionOf(body) + 0.5 * solve(massMatrix(body), impulse));
}

double partThatGains(const btRigidBody& body, const Vector6& impulse, double most) {
    const double whole = gainOf(body, impulse);
    if (whole <= std::max(0.0, most)) return 1.0;
    // s of the impulse gives a s + b s^2
    const double b = 0.5 * impulse.dot(solve(massMatrix(body), impulse)), a = whole - b;
    const double root = std::sqrt(std::max(0.0, a * a + 4.0 * b * std::max(0.0, most)));
    return std::clamp((root - a) / (2.0 * b), 0.0, 1.0);
}

}  // namespace cloth
