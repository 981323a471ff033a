#pragma once

#include <string_view>
#include <vector>

#include "data/core/types.h"

namespace cloth {

using MatrixF = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using VectorF = Eigen::VectorXf;

/// How a group of feature columns is normalised.
enum class FeatureKind {
    vector,  ///< three components, mean 0, one standard deviation: no axis is special
    scalar,  ///< own mean and standard deviation
    fixed,   ///< of order one by construction: left alone
};

/// Some neighbouring columns of a feature matrix.
struct FeatureGroup {
    std::string_view name;
    int size;
    FeatureKind kind;
};

using FeatureLayout = std::vector<FeatureGroup>;

// Each matrix of features has a list of names and a table, in the order of the columns:
// first_column<NodeFeature::normal> is where a group begins.

enum class NodeFeature {
    velocity,
    normal,
    acceleration,
    projection,
    log_mass,
    pinned,
    material,
    near_obstacle,
    elastic_now,  ///< this and what follows: with force features only
    elastic_base,
    force_base,
    jacobi_base
};
inline constexpr FeatureGroup node_groups[] = {
    {"velocity", 3, FeatureKind::vector},    {"normal", 3, FeatureKind::fixed},
    {"acceleration", 3, FeatureKind::fixed}, {"projection", 3, FeatureKind::vector},
    {"log_mass", 1, FeatureKind::scalar},    {"pinned", 1, FeatureKind::fixed},
    {"material", 3, FeatureKind::fixed},     {"near_obstacle", 1, FeatureKind::fixed},
    {"elastic_now", 3, FeatureKind::vector}, {"elastic_base", 3, FeatureKind::vector},
    {"force_base", 3, FeatureKind::vector},  {"jacobi_base", 3, FeatureKind::vector}};

enum class EdgeFeature { relative_now, strain_now, relative_base, strain_base, log_rest_length };
inline constexpr FeatureGroup edge_groups[] = {{"relative_now", 3, FeatureKind::vector},
                                               {"strain_now", 1, FeatureKind::scalar},
                                               {"relative_base", 3, FeatureKind::vector},
                                               {"strain_base", 1, FeatureKind::scalar},
                                               {"log_rest_length", 1, FeatureKind::scalar}};

enum class WorldFeature {
    relative_now,
    length_now,
    relative_next,
    length_next,
    body_velocity,
    body_normal,
    distance_now,
    distance_next,
    nearness
};
inline constexpr FeatureGroup world_groups[] = {
    {"relative_now", 3, FeatureKind::vector},  {"length_now", 1, FeatureKind::scalar},
    {"relative_next", 3, FeatureKind::vector}, {"length_next", 1, FeatureKind::scalar},
    {"body_velocity", 3, FeatureKind::vector}, {"body_normal", 3, FeatureKind::fixed},
    {"distance_now", 1, FeatureKind::scalar},  {"distance_next", 1, FeatureKind::scalar},
    {"nearness", 1, FeatureKind::fixed}};

enum class BodyFeature { velocity, normal, friction };
inline constexpr FeatureGroup body_groups[] = {{"velocity", 3, FeatureKind::vector},
                                               {"normal", 3, FeatureKind::fixed},
                                               {"friction", 1, FeatureKind::fixed}};

namespace detail {

constexpr const FeatureGroup* groups_of(NodeFeature) {
    return node_groups;
}
constexpr const FeatureGroup* groups_of(EdgeFeature) {
    return edge_groups;
}
constexpr const FeatureGroup* groups_of(WorldFeature) {
    return world_groups;
}
constexpr const FeatureGroup* groups_of(BodyFeature) {
    return body_groups;
}

constexpr int columns_of(const FeatureGroup* groups, int count) {
    int columns = 0;
    for (int k = 0; k < count; ++k) columns += groups[k].size;
    return columns;
}

}  // namespace detail

/// The first column of a group in its matrix.
template <auto feature>
constexpr int first_column = detail::columns_of(detail::groups_of(feature),
                                                static_cast<int>(feature));

FeatureLayout node_layout(bool force_features);
FeatureLayout edge_layout();
FeatureLayout world_layout();
FeatureLayout body_layout();

/// Number of columns.
int feature_count(const FeatureLayout& layout);

/// Normalisation of one feature matrix: column c becomes (x - mean[c]) / deviation[c].
struct FeatureStatistics {
    VectorF mean, deviation;
};

/// Running sums behind FeatureStatistics.
class StatisticsAccumulator {
 public:
    explicit StatisticsAccumulator(FeatureLayout layout);

    /// Adds the rows of `features`, or only those where `mask` is 1 and not 0, if one is given.
    void add(const MatrixF& features, const VectorF* mask = nullptr);

    /// A column that (nearly) never varies gets deviation 1: it carries no information, and must
    /// not be blown up when it differs in use.
    FeatureStatistics statistics() const;

    /// Row count, sums and sums of squares in one vector, for checkpoints.
    Eigen::VectorXd state() const;
    void set_state(const Eigen::VectorXd& state);

 private:
    FeatureLayout m_layout;
    double m_count = 0.0;
    Eigen::VectorXd m_sum, m_squares;
};

}  // namespace cloth
