#include "data/core/pose.h"

#include <cmath>

namespace cloth {

Pose interpolate(const Pose& a, const Pose& b, double s) {
    if (s == 0.0 || a.matrix() == b.matrix()) return a;
    if (s == 1.0) return b;
    // Poses from single precision are rotations up to 1e-7 only, which motion beyond b magnifies.
    const Eigen::Quaterniond from = Eigen::Quaterniond(a.linear()).normalized();
    const Eigen::Quaterniond to = Eigen::Quaterniond(b.linear()).normalized();
    Pose pose = Pose::Identity();
    pose.linear() = from.slerp(s, to).toRotationMatrix();
    pose.translation() = (1.0 - s) * a.translation() + s * b.translation();
    return pose;
}

// Eigen's FromTwoVectors is the same, with a singular value decomposition for opposite directions
// that takes seconds to compile wherever it is used.
Eigen::Quaterniond rotation_between(const Vec3& from, const Vec3& to) {
    const Vec3 a = from.normalized(), b = to.normalized();
    const double cosine = b.dot(a);
    Eigen::Quaterniond turn;
    if (cosine < -1.0 + Eigen::NumTraits<double>::dummy_precision()) {
        turn.vec() = a.unitOrthogonal();
        turn.w() = 0.0;
        return turn;
    }
    const double twice_cosine_of_half = std::sqrt((1.0 + cosine) * 2.0);
    turn.vec() = a.cross(b) * (1.0 / twice_cosine_of_half);
    turn.w() = twice_cosine_of_half * 0.5;
    return turn;
}

Points transformed(const Points& points, const Pose& pose) {
    return (points * pose.linear().transpose()).rowwise() + pose.translation().transpose();
}

}  // namespace cloth
