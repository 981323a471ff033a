#include "data/core/pose.h"

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

Points transformed(const Points& points, const Pose& pose) {
    return (points * pose.linear().transpose()).rowwise() + pose.translation().transpose();
}

}  // namespace cloth
