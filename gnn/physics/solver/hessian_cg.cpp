#include "gnn/physics/solver/hessian_cg.h"

namespace cloth {

template <class Real>
void HessianCg<Real>::allocate() {
    for (std::vector<Real>* array : {&m_direction, &m_product}) array->resize(lanes(), Real(0));
    m_solution.resize(lanes(), 0.0);
}

template <class Real>
void HessianCg<Real>::solve(FabricHessian<Real>& hessian, const Points& at,
                            const ContactHessian& contacts, int iterations, Points& out) {
    allocate();
    m_contacts.take(contacts, m_factor->part_of(), nullptr);
    out.resize(m_step.rows(), 3);
    const int threads = m_factor->threads();
#pragma omp parallel num_threads(threads) if (threads > 1)
    iterate(Crew(), hessian, at, iterations, out);
}

template <class Real>
void HessianCg<Real>::iterate(const Crew& crew, FabricHessian<Real>& hessian, const Points& at,
                              int iterations, Points& out) {
    crew.for_halves([&](size_t half) { hessian.linearise_faces(half, at); });
    crew.for_parts([&](size_t part) {
        for_rows(part, [&](size_t row) {
            store<Real>(m_direction.data() + 4 * row, load(m_work.data() + 4 * row));
            store(m_solution.data() + 4 * row, DoubleLanes{});
        });
        m_sums[part].power = power_of(part);
    });
    Crew::wait();
    crew.for_parts(
        [&](size_t part) { for_rows(part, [&](size_t row) { hessian.linearise_row(row); }); });
    double power_now = total(&Sums::power);
    const double enough = 1e-6 * power_now;
    for (int k = 0; k < iterations && power_now > enough; ++k) {
        Crew::wait();
        crew.for_parts([&](size_t part) { multiply(part, hessian); });
        Crew::wait();
        const double step = power_now / total(&Sums::curvature);
        crew.for_parts([&](size_t part) { advance(part, step); });
        if (k + 1 == iterations) break;
        m_factor->solve(crew, m_work.data());
        crew.for_parts([&](size_t part) { m_sums[part].power = power_of(part); });
        Crew::wait();
        const double next = total(&Sums::power);
        const auto beta = static_cast<Real>(next / power_now);
        power_now = next;
        crew.for_parts([&](size_t part) {
            for_rows(part, [&](size_t row) {
                Real* const d = m_direction.data() + 4 * row;
                store<Real>(d, load(m_work.data() + 4 * row) + beta * load(d));
            });
        });
    }
    crew.for_parts([&](size_t part) {
        for_rows(part, [&](size_t row) {
            for (size_t c = 0; c < 3; ++c) out.data()[3 * row + c] = m_solution[4 * row + c];
        });
    });
}

template <class Real>
void HessianCg<Real>::multiply(size_t part, const FabricHessian<Real>& hessian) {
    const double by_fabric = sum_rows(part, [&](size_t row) -> Lanes<Real> {
        const Lanes<Real> product = hessian.product(row, m_direction.data());
        store<Real>(m_product.data() + 4 * row, product);
        return load(m_direction.data() + 4 * row) * product;
    });
    m_contacts.find_motions(part, m_direction.data());
    m_sums[part].curvature =
        by_fabric + m_contacts.add_product(part, 0.0, AffineFields::Coefficients::Zero(),
                                           m_direction.data(), m_product.data());
}

/// x += step d, r -= step A d.
template <class Real>
void HessianCg<Real>::advance(size_t part, double step) {
    const auto scale = static_cast<Real>(step);
    for_rows(part, [&](size_t row) {
        double* const x = m_solution.data() + 4 * row;
        Real* const r = m_residual.data() + 4 * row;
        const Lanes<Real> product = load(m_product.data() + 4 * row) + m_contacts.force(row);
        const Lanes<Real> residual = load(r) - scale * product;
        store(x, load(x) + step * widened(load(m_direction.data() + 4 * row)));
        store<Real>(r, residual);
        store<Real>(m_work.data() + 4 * row, residual);
    });
}

template <class Real>
double HessianCg<Real>::total(double Sums::*sum) const {
    return (m_sums[0].*sum + m_sums[1].*sum) + m_sums[Crew::top].*sum;
}

template class HessianCg<float>;
template class HessianCg<double>;

}  // namespace cloth
