#include "gnn/physics/solver/preconditioned_rows.h"

namespace cloth {

template <class Real>
const Points& PreconditionedRows<Real>::start(const Factor& factor, const Points& b) {
    m_factor = &factor;
    m_residual.resize(lanes(), Real(0));
    m_work.resize(4 * factor.work_rows(), Real(0));
    m_step.resize(factor.size(), 3);
    const int threads = factor.threads();
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
        const Crew crew;
        crew.for_parts([&](size_t part) { take(part, b); });
        factor.solve(crew, m_work.data());
        crew.for_parts([&](size_t part) {
            for_rows(part, [&](size_t row) {
                for (size_t k = 0; k < 3; ++k)
                    m_step.data()[3 * row + k] = double(m_work[4 * row + k]);
            });
        });
    }
    return m_step;
}

template <class Real>
void PreconditionedRows<Real>::take(size_t part, const Points& b) {
    for_rows(part, [&](size_t row) {
        const double* const from = b.data() + 3 * row;
        const Lanes<Real> lanes = {Real(from[0]), Real(from[1]), Real(from[2]), Real(0)};
        store<Real>(m_residual.data() + 4 * row, lanes);
        store<Real>(m_work.data() + 4 * row, lanes);
    });
}

template class PreconditionedRows<float>;
template class PreconditionedRows<double>;

}  // namespace cloth
