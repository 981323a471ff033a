#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

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
    std::string name;
    int size;
    FeatureKind kind;
};

using FeatureLayout = std::vector<FeatureGroup>;

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
