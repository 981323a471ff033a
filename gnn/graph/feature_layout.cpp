#include "gnn/graph/feature_layout.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth {

FeatureLayout node_layout(bool force_features) {
    FeatureLayout layout = {
        {"velocity", 3, FeatureKind::vector},    {"normal", 3, FeatureKind::fixed},
        {"acceleration", 3, FeatureKind::fixed}, {"projection", 3, FeatureKind::vector},
        {"log_mass", 1, FeatureKind::scalar},    {"pinned", 1, FeatureKind::fixed},
        {"material", 3, FeatureKind::fixed},     {"near_obstacle", 1, FeatureKind::fixed},
    };
    if (force_features)
        for (const char* name : {"elastic_now", "elastic_base", "force_base", "jacobi_base"})
            layout.push_back({name, 3, FeatureKind::vector});
    return layout;
}

FeatureLayout edge_layout() {
    return {{"relative_now", 3, FeatureKind::vector},
            {"strain_now", 1, FeatureKind::scalar},
            {"relative_base", 3, FeatureKind::vector},
            {"strain_base", 1, FeatureKind::scalar},
            {"log_rest_length", 1, FeatureKind::scalar}};
}

FeatureLayout world_layout() {
    return {{"relative_now", 3, FeatureKind::vector},  {"length_now", 1, FeatureKind::scalar},
            {"relative_next", 3, FeatureKind::vector}, {"length_next", 1, FeatureKind::scalar},
            {"body_velocity", 3, FeatureKind::vector}, {"body_normal", 3, FeatureKind::fixed},
            {"distance_now", 1, FeatureKind::scalar},  {"distance_next", 1, FeatureKind::scalar},
            {"nearness", 1, FeatureKind::fixed}};
}

FeatureLayout body_layout() {
    return {{"velocity", 3, FeatureKind::vector},
            {"normal", 3, FeatureKind::fixed},
            {"friction", 1, FeatureKind::fixed}};
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
