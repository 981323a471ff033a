#include "collision/proximity/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace cloth {

/// Vertices, then edge midpoints, then face centres.
static Points sample_points(const Garment& garment, const Points& x) {
    const auto& edges = garment.edges();
    const Faces& faces = garment.rest().faces;
    const auto edge_count = static_cast<Eigen::Index>(edges.size());
    Points samples(x.rows() + edge_count + faces.rows(), 3);
    samples.topRows(x.rows()) = x;
    for (Eigen::Index e = 0; e < edge_count; ++e) {
        const auto& [a, b] = edges[static_cast<size_t>(e)];
        samples.row(x.rows() + e) = 0.5 * (x.row(a) + x.row(b));
    }
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        samples.row(x.rows() + edge_count + f) =
            (x.row(faces(f, 0)) + x.row(faces(f, 1)) + x.row(faces(f, 2))) / 3.0;
    return samples;
}

using Distances = Eigen::Ref<const VectorX>;

static double depth(const Distances& distance) {
    return distance.size() > 0 ? std::max(0.0, -distance.minCoeff()) : 0.0;
}

static double fraction_inside(const Distances& distance) {
    if (distance.size() == 0) return 0.0;
    const auto inside = (distance.array() < -PenetrationStatistics::tolerance).count();
    return static_cast<double>(inside) / static_cast<double>(distance.size());
}

PenetrationStatistics measure_penetration(Proximity& proximity, const Boundary& boundary,
                                          const Garment& garment, const Points& x, StepEnd end) {
    const auto edge_count = static_cast<Eigen::Index>(garment.edges().size());
    VectorX distance;
    proximity.signed_distance(sample_points(garment, x), boundary, end, distance);
    PenetrationStatistics statistics;
    statistics.max_depth = depth(distance);
    statistics.vertex_depth = depth(distance.head(x.rows()));
    statistics.fraction_inside = fraction_inside(distance.head(x.rows()));
    statistics.edge_fraction = fraction_inside(distance.segment(x.rows(), edge_count));
    statistics.face_fraction = fraction_inside(distance.tail(garment.face_count()));
    return statistics;
}

/// The smallest value that at least `percent` of the sorted values do not exceed.
static double percentile(const std::vector<double>& sorted, double percent) {
    const auto rank = std::ceil(percent / 100.0 * static_cast<double>(sorted.size()));
    return sorted[static_cast<size_t>(std::max(1.0, rank)) - 1];
}

StretchStatistics measure_stretch(const Garment& garment, const Points& x) {
    std::vector<double> ratios;
    ratios.reserve(garment.edges().size());
    const Points& rest = garment.rest().vertices;
    for (const auto& [a, b] : garment.edges()) {
        const double rest_length = (rest.row(a) - rest.row(b)).norm();
        const double ratio = (x.row(a) - x.row(b)).norm() / rest_length;
        if (rest_length > 0.0)  // NaN is the worst stretch of all
            ratios.push_back(std::isnan(ratio) ? std::numeric_limits<double>::infinity() : ratio);
    }
    if (ratios.empty()) return {};
    std::sort(ratios.begin(), ratios.end());
    return {percentile(ratios, 50), percentile(ratios, 99), ratios.back()};
}

void JitterMeter::add(const Points& x) {
    if (m_frames >= 3 && x.rows() == m_before[0].rows() && x.rows() > 0) {
        const Points third = x - 3.0 * (m_before[0] - m_before[1]) - m_before[2];
        const double mean_square = third.squaredNorm() / static_cast<double>(64 * x.rows());
        m_last = std::sqrt(mean_square);
        m_sum_of_squares += mean_square;
    }
    m_before[2].swap(m_before[1]);
    m_before[1].swap(m_before[0]);
    m_before[0] = x;
    ++m_frames;
}

double JitterMeter::mean() const {
    return m_frames > 3 ? std::sqrt(m_sum_of_squares / (m_frames - 3)) : 0.0;
}

}  // namespace cloth
