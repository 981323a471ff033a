#include "gnn/physics/solver/deflated_cg.h"

namespace cloth {
template <class Real>
void DeflatedCg<Real>::take_fields(const AffineCorrection& affine) {
    const auto& fields = affine.fields().columns();
    const auto& p_fields = affine.p_columns();
    m_fields.assign(fields.data(), fields.data() + fields.size());
    m_p_fields.assign(p_fields.data(), p_fields.data() + p_fields.size());
}

template <class Real>
void DeflatedCg<Real>::allocate() {
    for (std::vector<Real>* array : {&m_fields, &m_p_fields, &m_direction, &m_p_direction})
        array->resize(lanes(), Real(0));
    m_solution.resize(lanes(), 0.0);
}

template <class Real>
void DeflatedCg<Real>::solve(const ContactHessian& contacts, AffineCorrection* affine,
                             int iterations, Points& out) {
    allocate();
    m_contacts.take(contacts, m_factor->part_of(), m_fields.data());
    out.resize(m_step.rows(), 3);
    const int threads = m_factor->threads();
#pragma omp parallel num_threads(threads) if (threads > 1)
    iterate(Crew(), affine, iterations, out);
}

template <class Real>
void DeflatedCg<Real>::iterate(const Crew& crew, AffineCorrection* affine, int iterations,
                               Points& out) {
    crew.for_parts([&](size_t part) { prepare(part, affine != nullptr); });
    Crew::wait();
    double power = total(&Sums::power);
    const double enough = 1e-6 * power;  // a few contacts are solved before the iterations end
    if (crew.leads()) m_deflated = affine && affine->factorise(total_system());
    Crew::wait();
    const bool deflated = m_deflated;
    Coefficients c = Coefficients::Zero(), all = Coefficients::Zero();
    if (deflated) {  // the affine part of the answer comes first: a step of length one
        c = -affine->coefficients(total_moments());
        all = c;
        crew.for_parts([&](size_t part) { turn_affinely(part, c); });
        Crew::wait();
        crew.for_parts([&](size_t part) { advance(part, 1.0, c); });
        precondition(crew, true);
        power = total(&Sums::power);
    } else {
        crew.for_parts([&](size_t part) { m_contacts.find_motions(part, m_work.data()); });
        Crew::wait();
    }
    double beta = 0.0, step = 0.0;
    for (int k = 0; power > enough; ++k) {
        // F' A z = F' r + F' blocks z, and the residual has no affine part
        if (deflated) c = beta * c + affine->coefficients(total_moments());
        crew.for_parts([&](size_t part) { turn(part, beta, c); });
        Crew::wait();
        step = power / curvature(affine, c);
        all += step * c;
        if (k + 1 >= iterations) break;
        crew.for_parts([&](size_t part) { advance(part, step, c); });
        step = 0.0;
        precondition(crew, deflated);
        const double next_power = total(&Sums::power);
        beta = next_power / power;
        power = next_power;
    }
    crew.for_parts([&](size_t part) { finish(part, step, all, out); });
}

template <class Real>
void DeflatedCg<Real>::precondition(const Crew& crew, bool deflated) {
    m_factor->solve(crew, m_work.data());
    Crew::wait();  // motions of couplings are those of rows in several parts
    crew.for_parts([&](size_t part) { measure(part, deflated); });
    Crew::wait();
}

/// d . A d. F' p_d is zero, since p_d is a sum of residuals.
template <class Real>
double DeflatedCg<Real>::curvature(const AffineCorrection* affine, const Coefficients& c) const {
    return total(&Sums::curvature) + (m_deflated ? affine->energy(c) : 0.0);
}

/// Sets the answer to zero and adds up what b tells.
template <class Real>
void DeflatedCg<Real>::prepare(size_t part, bool deflated) {
    Sums& sums = m_sums[part];
    sums.system.setZero();
    if (deflated) m_contacts.add_to(part, sums.system);
    DoubleLanes moments[AffineFields::count] = {};
    sums.power = sum_rows(part, [&](size_t row) -> Lanes<Real> {
        const Lanes<Real> r = load(m_residual.data() + 4 * row);
        const Lanes<Real> z = load(m_work.data() + 4 * row);
        const DoubleLanes f = widened(load(m_fields.data() + 4 * row)), wide = widened(r);
        for (int k = 0; k < AffineFields::count; ++k) moments[k] += f[k] * wide;
        store(m_solution.data() + 4 * row, DoubleLanes{});
        store<Real>(m_direction.data() + 4 * row, Lanes<Real>{});
        store<Real>(m_p_direction.data() + 4 * row, Lanes<Real>{});
        return r * z;
    });
    for (int k = 0; k < AffineFields::count; ++k) store(sums.moments[k], moments[k]);
}

/// After a solve with P.
template <class Real>
void DeflatedCg<Real>::measure(size_t part, bool deflated) {
    Sums& sums = m_sums[part];
    sums.power = power_of(part);
    m_contacts.find_motions(part, m_work.data());
    if (!deflated) return;
    for (auto& row : sums.moments) store(row, DoubleLanes{});
    m_contacts.add_moments(part, m_work.data(), sums.moments);
}

/// d = 0: all of the direction is affine.
template <class Real>
void DeflatedCg<Real>::turn_affinely(size_t part, const Coefficients& c) {
    for_rows(part, [&](size_t row) { store<Real>(m_work.data() + 4 * row, Lanes<Real>{}); });
    m_contacts.stand_still(part);
    m_contacts.add_product(part, 0.0, c, m_direction.data(), m_work.data());
}

/// d = z + beta d; c is so that A (d - F c) has no affine part. The direction before has none, nor
/// has the residual. p_d follows from the residuals, so that P itself is never multiplied.
template <class Real>
void DeflatedCg<Real>::turn(size_t part, double beta, const Coefficients& c) {
    const auto scale = static_cast<Real>(beta);
    const double by_p = sum_rows(part, [&](size_t row) -> Lanes<Real> {
        Real* const d = m_direction.data() + 4 * row;
        Real* const p_d = m_p_direction.data() + 4 * row;
        Real* const work = m_work.data() + 4 * row;
        const Lanes<Real> direction = load(work) + scale * load(d);
        const Lanes<Real> product = load(m_residual.data() + 4 * row) + scale * load(p_d);
        store<Real>(d, direction);
        store<Real>(p_d, product);
        store<Real>(work, product);
        return direction * product;
    });
    m_sums[part].curvature =
        by_p + m_contacts.add_product(part, beta, c, m_direction.data(), m_work.data());
}

/// x += step d, r -= step A (d - F c), without the affine part of x.
template <class Real>
void DeflatedCg<Real>::advance(size_t part, double step, const Coefficients& c) {
    const auto scale = static_cast<Real>(step);
    const FieldRows<Real> rows(c);
    for_rows(part, [&](size_t row) {
        double* const x = m_solution.data() + 4 * row;
        Real* const r = m_residual.data() + 4 * row;
        Real* const work = m_work.data() + 4 * row;
        const Lanes<Real> product =
            (load(work) + m_contacts.force(row)) - rows.at(m_p_fields.data() + 4 * row);
        const Lanes<Real> residual = load(r) - scale * product;
        store(x, load(x) + step * widened(load(m_direction.data() + 4 * row)));
        store<Real>(r, residual);
        store<Real>(work, residual);
    });
}

/// out = x + step d - F all.
template <class Real>
void DeflatedCg<Real>::finish(size_t part, double step, const Coefficients& all,
                              Points& out) const {
    const FieldRows<double> rows(all);
    for_rows(part, [&](size_t row) {
        const DoubleLanes x = load(m_solution.data() + 4 * row) +
                              step * widened(load(m_direction.data() + 4 * row)) -
                              rows.at(widened(load(m_fields.data() + 4 * row)));
        for (size_t k = 0; k < 3; ++k) out.data()[3 * row + k] = x[k];
    });
}

template <class Real>
double DeflatedCg<Real>::total(double Sums::*sum) const {
    return (m_sums[0].*sum + m_sums[1].*sum) + m_sums[Crew::top].*sum;
}

template <class Real>
AffineFields::Coefficients DeflatedCg<Real>::total_moments() const {
    Coefficients total = Coefficients::Zero();
    for (const Sums& sums : m_sums)
        for (int k = 0; k < AffineFields::count; ++k)
            total.row(k) += Eigen::Map<const Eigen::RowVector3d>(sums.moments[k]);
    return total;
}

template <class Real>
AffineFields::System DeflatedCg<Real>::total_system() const {
    return m_sums[0].system + m_sums[1].system + m_sums[Crew::top].system;
}

template class DeflatedCg<float>;
template class DeflatedCg<double>;

}  // namespace cloth
