#include "data/body/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

/// Calls `use` with joint and weight of each influence on a vertex.
template <class Use>
void for_each_influence(const SkinWeights& weights, int vertex, const Use& use) {
    const auto i = static_cast<size_t>(vertex);
    for (int k = weights.begin[i]; k < weights.begin[i + 1]; ++k)
        use(weights.joints[static_cast<size_t>(k)], weights.values[static_cast<size_t>(k)]);
}

}  // namespace

/// Of the vertices of each joint, so many at equal distances in their order.
void JointFit::choose_rows(const SkinWeights& weights, int per_joint) {
    std::vector<int> count(static_cast<size_t>(m_joints), 0), seen = count;
    for (const int joint : weights.joints) ++count[static_cast<size_t>(joint)];
    for (int i = 0; i < weights.vertex_count(); ++i) {
        bool chosen = false;
        for_each_influence(weights, i, [&](int joint, double) {
            const auto j = static_cast<size_t>(joint);
            const int every = std::max(1, count[j] / per_joint);
            chosen = seen[j]++ % every == 0 || chosen;
        });
        if (chosen) m_rows.push_back(i);
    }
}

JointFit::JointFit(const Points& rest, const SkinWeights& weights, int per_joint)
    : m_vertices(rest.rows()) {
    check_range("JointFit.per_joint", per_joint, 8, 1e6);
    if (weights.vertex_count() != rest.rows())
        throw ArgumentError("JointFit: weights",
                            "are of " + std::to_string(weights.vertex_count()) +
                                " vertices, the skin has " + std::to_string(rest.rows()),
                            "give the weights of this skin");
    for (const int joint : weights.joints) m_joints = std::max(m_joints, joint + 1);
    choose_rows(weights, per_joint);
    const auto for_all = [&](const auto& use) {
        for (size_t row = 0; row < m_rows.size(); ++row)
            for_each_influence(weights, m_rows[row], [&](int joint, double weight) {
                use(static_cast<int>(row), m_rows[row], static_cast<size_t>(joint), weight);
            });
    };
    m_unknown.assign(static_cast<size_t>(m_joints), -1);
    int count = 0;
    for_all([&](int, int, size_t j, double) {
        if (m_unknown[j] < 0) m_unknown[j] = count++;
    });
    // Unknowns relative to the middle of what a joint moves, in units of its size: well
    // conditioned.
    VectorX sum = VectorX::Zero(count);
    m_centre.setZero(count, 3);
    m_radius.setZero(count);
    for_all([&](int, int i, size_t j, double w) {
        sum[m_unknown[j]] += w;
        m_centre.row(m_unknown[j]) += w * rest.row(i);
    });
    m_centre.array().colwise() /= sum.array();
    for_all([&](int, int i, size_t j, double w) {
        m_radius[m_unknown[j]] += w * (rest.row(i) - m_centre.row(m_unknown[j])).squaredNorm();
    });
    m_radius = (m_radius.array() / sum.array()).sqrt().max(1e-6);
    std::vector<Eigen::Triplet<double>> entries;
    for_all([&](int row, int i, size_t j, double w) {
        const int k = m_unknown[j];
        for (int axis = 0; axis < 3; ++axis)
            entries.emplace_back(row, 4 * k + axis,
                                 w * (rest(i, axis) - m_centre(k, axis)) / m_radius[k]);
        entries.emplace_back(row, 4 * k + 3, w);
    });
    m_blend.resize(static_cast<Eigen::Index>(m_rows.size()), 4 * count);
    m_blend.setFromTriplets(entries.begin(), entries.end());
    m_normal.compute(Eigen::MatrixXd(m_blend.transpose() * m_blend));
    if (count == 0 || m_normal.info() != Eigen::Success || !m_normal.isPositive() ||
        !(m_normal.rcond() > 1e-12))
        throw ArgumentError("JointFit", "the skin does not determine its joints",
                            "give a skin in which each joint moves vertices of its own");
}

double JointFit::find(const Points& skin, std::vector<SkinMatrix>& matrices) const {
    if (skin.rows() != m_vertices || !skin.allFinite())
        return std::numeric_limits<double>::infinity();
    const Points seen = skin(m_rows, Eigen::all);
    const Eigen::MatrixXd solution = m_normal.solve(m_blend.transpose() * seen);
    matrices.assign(static_cast<size_t>(m_joints), SkinMatrix::Identity());
    for (size_t j = 0; j < matrices.size(); ++j) {
        const int k = m_unknown[j];
        if (k < 0) continue;
        const Eigen::Matrix3d linear = solution.middleRows<3>(4 * k).transpose() / m_radius[k];
        matrices[j].leftCols<3>() = linear;
        matrices[j].col(3) =
            solution.row(4 * k + 3).transpose() - linear * m_centre.row(k).transpose();
    }
    return std::sqrt((m_blend * solution - seen).squaredNorm() / static_cast<double>(seen.rows()));
}

}  // namespace cloth
