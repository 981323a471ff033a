#include "gnn/physics/energy/elastic.h"

#include <array>

namespace cloth {
namespace {

constexpr int parts = 4;
constexpr size_t enough_hinges = 4000;  // for the sums of parts to cost little beside them
constexpr Eigen::Index rows_at_once = 512;

}  // namespace

ElasticEnergy::ElasticEnergy(const Garment& garment)
    : m_strain(garment), m_bending(garment), m_in_parts(garment.hinges().size() >= enough_hinges) {
}

ElasticEnergy::Terms ElasticEnergy::gradient(const Points& x, Points& gradient) const {
    if (!m_in_parts) {
        gradient.setZero(x.rows(), 3);
        const double strain = m_strain.add_gradient(x, gradient);
        return {strain, m_bending.add_gradient(x, gradient)};
    }
    static thread_local std::array<Points, parts> scratch;  // of the thread that calls
    std::array<Points, parts>& sums = scratch;
    std::array<Terms, parts> terms;
    gradient.resize(x.rows(), 3);
#pragma omp parallel
    {
#pragma omp for schedule(static, 1)
        for (int part = 0; part < parts; ++part) {
            const auto k = static_cast<size_t>(part);
            sums[k].setZero(x.rows(), 3);
            terms[k].strain = m_strain.add_gradient(x, part, parts, sums[k]);
            terms[k].bending = m_bending.add_gradient(x, part, parts, sums[k]);
        }
#pragma omp for schedule(static)
        for (Eigen::Index first = 0; first < x.rows(); first += rows_at_once) {
            const Eigen::Index rows = std::min(rows_at_once, x.rows() - first);
            const auto of = [&](size_t k) { return sums[k].middleRows(first, rows); };
            gradient.middleRows(first, rows) = of(0) + of(1) + of(2) + of(3);
        }
    }
    Terms total;
    for (const Terms& part : terms) {
        total.strain += part.strain;
        total.bending += part.bending;
    }
    return total;
}

void ElasticEnergy::add_hessian(const Points& x, const BlockPattern& pattern, HessianKind kind,
                                double* values) const {
    m_strain.add_hessian(x, pattern, kind, values);
    m_bending.add_hessian(x, pattern, kind, values);
}

}  // namespace cloth
