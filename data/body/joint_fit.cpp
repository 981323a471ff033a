#include "data/body/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "data/core/errors.h"

namespace cloth {

namespace {

/// Calls `use` with vertex, joint and weight of each influence.
template <class Use>
void for_each_influence(const SkinWeights& weights, const Use& use) {
    for (int i = 0; i < weights.vertex_count(); ++i)
        for (int k = weights.begin[static_cast<size_t>(i)];
             k < weights.begin[static_cast<size_t>(i) + 1]; ++k)
            use(i, weights.joints[static_cast<size_t>(k)], weights.values[static_cast<size_t>(k)]);
}

}  // namespace

JointFit::JointFit(const Points& rest, const SkinWeights& weights) {
    if (weights.vertex_count() != rest.rows())
        throw ArgumentError("JointFit: weights",
                            "are of " + std::to_string(weights.vertex_count()) +
                                " vertices, the skin has " + std::to_string(rest.rows()),
                            "give the weights of this skin");
    for_each_influence(weights, [&](int, int j, double) { m_joints = std::max(m_joints, j + 1); });
    m_unknown.assign(static_cast<size_t>(m_joints), -1);
    int count = 0;
    for_each_influence(weights, [&](int, int j, double) {
        if (m_unknown[static_cast<size_t>(j)] < 0) m_unknown[static_cast<size_t>(j)] = count++;
    });
    // Unknowns relative to the middle of what a joint moves, in units of its size: well conditioned.
    VectorX sum = VectorX::Zero(count);
    m_centre.setZero(count, 3);
    m_radius.setZero(count);
    const auto unknown = [&](int joint) { return m_unknown[static_cast<size_t>(joint)]; };
    for_each_influence(weights, [&](int i, int j, double w) {
        sum[unknown(j)] += w;
        m_centre.row(unknown(j)) += w * rest.row(i);
    });
    m_centre.array().colwise() /= sum.array();
    for_each_influence(weights, [&](int i, int j, double w) {
        m_radius[unknown(j)] += w * (rest.row(i) - m_centre.row(unknown(j))).squaredNorm();
    });
    m_radius = (m_radius.array() / sum.array()).sqrt().max(1e-6);
    std::vector<Eigen::Triplet<double>> entries;
    for_each_influence(weights, [&](int i, int j, double w) {
        const int k = unknown(j);
        for (int axis = 0; axis < 3; ++axis)
            entries.emplace_back(i, 4 * k + axis,
                                 w * (rest(i, axis) - m_centre(k, axis)) / m_radius[k]);
        entries.emplace_back(i, 4 * k + 3, w);
    });
    m_blend.resize(rest.rows(), 4 * count);
    m_blend.setFromTriplets(entries.begin(), entries.end());
    m_normal.compute(Eigen::MatrixXd(m_blend.transpose() * m_blend));
    if (count == 0 || m_normal.info() != Eigen::Success || !m_normal.isPositive() ||
        !(m_normal.rcond() > 1e-12))
        throw ArgumentError("JointFit", "the skin does not determine its joints",
                            "give a skin in which each joint moves vertices of its own");
}

double JointFit::find(const Points& skin, std::vector<SkinMatrix>& matrices) const {
    if (skin.rows() != m_blend.rows() || !skin.allFinite())
        return std::numeric_limits<double>::infinity();
    const Eigen::MatrixXd solution = m_normal.solve(m_blend.transpose() * skin);
    matrices.assign(static_cast<size_t>(m_joints), SkinMatrix::Identity());
    for (size_t j = 0; j < matrices.size(); ++j) {
        const int k = m_unknown[j];
        if (k < 0) continue;
        const Eigen::Matrix3d linear = solution.middleRows<3>(4 * k).transpose() / m_radius[k];
        matrices[j].leftCols<3>() = linear;
        matrices[j].col(3) =
            solution.row(4 * k + 3).transpose() - linear * m_centre.row(k).transpose();
    }
    return std::sqrt((m_blend * solution - skin).squaredNorm() / static_cast<double>(skin.rows()));
}

}  // namespace cloth
