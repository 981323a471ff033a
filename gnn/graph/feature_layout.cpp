#include "gnn/graph/feature_layout.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace cloth {

static_assert(std::size(node_groups) == size_t(NodeFeature::jacobi_base) + 1);
static_assert(std::size(edge_groups) == size_t(EdgeFeature::log_rest_length) + 1);
static_assert(std::size(world_groups) == size_t(WorldFeature::nearness) + 1);
static_assert(std::size(body_groups) == size_t(BodyFeature::friction) + 1);

FeatureLayout node_layout(bool force_features) {
    const FeatureGroup* end =
        force_features ? std::end(node_groups) : node_groups + size_t(NodeFeature::elastic_now);
    return {std::begin(node_groups), end};
}

FeatureLayout edge_layout() {
    return {std::begin(edge_groups), std::end(edge_groups)};
}

FeatureLayout world_layout() {
    return {std::begin(world_groups), std::end(world_groups)};
}

FeatureLayout body_layout() {
    return {std::begin(body_groups), std::end(body_groups)};
}

int feature_count(const FeatureLayout& layout) {
    int count = 0;
    for (const FeatureGroup& group : layout) count += group.size;
    return count;
}

StatisticsAccumulator::StatisticsAccumulator(FeatureLayout layout)
    : m_layout(std::move(layout)),
      m_sum(Eigen::VectorXd::Zero(feature_count(m_layout))),
      m_squares(m_sum) {
}

void StatisticsAccumulator::add(const MatrixF& features, const VectorF* mask) {
    if (!mask) {
        m_sum += features.cast<double>().colwise().sum().transpose();
        m_squares += features.cast<double>().cwiseAbs2().colwise().sum().transpose();
        m_count += static_cast<double>(features.rows());
        return;
    }
    const Eigen::VectorXd weights = mask->cast<double>();
    m_sum += features.cast<double>().transpose() * weights;
    m_squares += features.cast<double>().cwiseAbs2().transpose() * weights;
    m_count += weights.sum();
}

FeatureStatistics StatisticsAccumulator::statistics() const {
    const int columns = feature_count(m_layout);
    FeatureStatistics out{VectorF::Zero(columns), VectorF::Ones(columns)};
    if (m_count == 0.0) return out;
    const auto guarded = [](double deviation) {
        return static_cast<float>(deviation > 1e-4 ? deviation : 1.0);
    };
    int c = 0;
    for (const FeatureGroup& group : m_layout) {
        const double mean_square = m_squares.segment(c, group.size).mean() / m_count;
        if (group.kind == FeatureKind::vector)
            out.deviation.segment(c, group.size).setConstant(guarded(std::sqrt(mean_square)));
        if (group.kind == FeatureKind::scalar) {
            const double mean = m_sum[c] / m_count;
            out.mean[c] = static_cast<float>(mean);
            out.deviation[c] = guarded(std::sqrt(std::max(0.0, mean_square - mean * mean)));
        }
        c += group.size;
    }
    return out;
}

Eigen::VectorXd StatisticsAccumulator::state() const {
    Eigen::VectorXd state(1 + 2 * m_sum.size());
    state << m_count, m_sum, m_squares;
    return state;
}

void StatisticsAccumulator::set_state(const Eigen::VectorXd& state) {
    m_count = state[0];
    m_sum = state.segment(1, m_sum.size());
    m_squares = state.tail(m_sum.size());
}

}  // namespace cloth
