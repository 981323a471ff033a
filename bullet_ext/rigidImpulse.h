#pragma once

#include "bullet_ext/bulletTypes.h"

class btRigidBody;

namespace cloth {

using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< along the axes, then about the centre of mass
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Whether impulses move the body.
bool isDynamic(const btRigidBody& body);

/// Centre of mass (m).
Vec3 centreOf(const btRigidBody& body);

/// kg, and kg m^2 about the centre of mass. Bodies that cannot turn count as ones that hardly can.
Matrix6 massMatrix(const btRigidBody& body);

/// The motion that an impulse (N s, N m s) gives to this mass.
Vector6 solve(const Matrix6& mass, const Vector6& impulse);

/// Velocity (m/s) and angular velocity (1/s).
Vector6 motionOf(const btRigidBody& body);

/// Velocity of a place of the body (m, m/s).
Vec3 velocityOf(const btRigidBody& body, const Vec3& place);

/// Energy of a motion of this mass (J).
double kineticEnergy(const Matrix6& mass, const Vector6& motion);

/// Energy (J) that a body gains by an impulse (N s, N m s).
double gainOf(const btRigidBody& body, const Vector6& impulse);

/// The largest part of an impulse, up to 1, by which the body gains no more than `most` (J); what
/// takes energy from it is allowed in any case.
double partThatGains(const btRigidBody& body, const Vector6& impulse, double most);

}  // namespace cloth
