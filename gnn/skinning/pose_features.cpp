#include "gnn/skinning/pose_features.h"

#include <Eigen/SVD>
#include <algorithm>
#include <string>

#include "data/core/errors.h"

namespace cloth {

namespace {

/// The rotation that is nearest to the linear part.
Eigen::Matrix3d rotation_of(const SkinMatrix& matrix) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix.leftCols<3>(),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0.0) u.col(2) *= -1.0;
    return u * svd.matrixV().transpose();
}

/// Two columns of a rotation, less those of the identity.
Eigen::Matrix<double, 6, 1> six(const Eigen::Matrix3d& rotation) {
    const Eigen::Matrix3d rest = rotation - Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 6, 1> values;
    values << rest.col(0), rest.col(1);
    return values;
}

}  // namespace

PoseFeatures::PoseFeatures(const SkinningConfig& config, const Body& body)
    : m_ages(config.ages), m_dt(config.dt) {
    for (const std::string& name : config.joints) {
        const int joint = body.joint(name);
        const int parent = body.joints()[static_cast<size_t>(joint)].parent;
        const auto found = std::find(m_joints.begin(), m_joints.end(), parent);
        if ((found == m_joints.end()) != m_joints.empty())
            throw ArgumentError("joint " + name, "does not come after its parent",
                                "use a network that was trained on this body");
        m_parents.push_back(static_cast<int>(found - m_joints.begin()));
        m_joints.push_back(joint);
    }
    m_root = body.joints()[static_cast<size_t>(m_joints.front())].position;
}

SeenPose PoseFeatures::see(const std::vector<SkinMatrix>& matrices) const {
    std::vector<Eigen::Matrix3d> rotations;
    for (const int joint : m_joints)
        rotations.push_back(rotation_of(matrices[static_cast<size_t>(joint)]));
    SeenPose pose;
    pose.root = rotations.front();
    const SkinMatrix& root = matrices[static_cast<size_t>(m_joints.front())];
    pose.root_position = root.leftCols<3>() * m_root + root.col(3);
    pose.local.resize(6 * static_cast<Eigen::Index>(m_joints.size() - 1));
    for (size_t j = 1; j < rotations.size(); ++j)
        pose.local.segment<6>(6 * static_cast<Eigen::Index>(j - 1)) =
            six(rotations[static_cast<size_t>(m_parents[j])].transpose() * rotations[j]);
    return pose;
}

void PoseFeatures::build(const std::vector<const SeenPose*>& poses, const Vec3& gravity,
                         VectorX& features) const {
    const SeenPose& now = *poses.front();
    const Eigen::Index inner = now.local.size();
    const auto past = static_cast<Eigen::Index>(m_ages.size()) - 1;
    features.resize(3 + inner + past * (inner + 9));
    features.head<3>() = now.root.transpose() * gravity.stableNormalized();
    features.segment(3, inner) = now.local;
    Eigen::Index at = 3 + inner;
    for (size_t k = 1; k < m_ages.size(); ++k) {
        const SeenPose& then = *poses[k];
        const double steps = m_ages[k];
        features.segment(at, inner) = (then.local - now.local) / steps;
        features.segment<6>(at + inner) = six(now.root.transpose() * then.root) / steps;
        features.segment<3>(at + inner + 6) =
            now.root.transpose() * (then.root_position - now.root_position) / (steps * m_dt);
        at += inner + 9;
    }
}

}  // namespace cloth
