#pragma once

#include <array>
#include <vector>

#include "gnn/physics/solver/affine_correction.h"
#include "gnn/physics/solver/contact_product.h"
#include "gnn/physics/solver/preconditioned_rows.h"

namespace cloth {

/// Conjugate gradients for (P + contact blocks) x = b, preconditioned by P and deflated of affine
/// displacements:
///
///     cg.take_fields(affine);                        // once for many solves
///     if (contacts.anticipate(cg.start(factor, b)))  // P^-1 b
///         cg.solve(contacts, &affine, iterations, x);
///
/// Two threads go through all of a solve together, each with its half of the rows, which stay in
/// its cache, in the layout and the precision of the factor. Sums are added up part by part in
/// double precision, so that the answer has the same bits with one thread.
///
/// The part that affine displacements have in directions and in the answer is kept as coefficients:
/// a direction is d - F c, and P times it p_d - P F c.
///
/// One object serves one thread at a time; after the first call nothing is allocated.
template <class Real>
class DeflatedCg : public PreconditionedRows<Real> {
 public:
    void take_fields(const AffineCorrection& affine);

    /// Goes on with the solve that was begun. Where `affine` is not null and F' A F is positive
    /// definite, its fields (those of the last take_fields()) are deflated.
    void solve(const ContactHessian& contacts, AffineCorrection* affine, int iterations,
               Points& out);

 private:
    using Coefficients = AffineFields::Coefficients;
    using Base = PreconditionedRows<Real>;
    using Base::for_rows, Base::lanes, Base::m_factor, Base::m_residual, Base::m_step, Base::m_work,
        Base::power_of, Base::sum_rows;
    /// Of one part of the rows.
    struct alignas(64) Sums {
        double power;      ///< r . z
        double curvature;  ///< d . A d, without what affine displacements add by P
        typename ContactProduct<Real>::Moments moments;
        AffineFields::System system;  ///< F' blocks F
    };

    // All threads of a crew go through these together.
    void iterate(const Crew& crew, AffineCorrection* affine, int iterations, Points& out);
    void precondition(const Crew& crew, bool deflated);
    double curvature(const AffineCorrection* affine, const Coefficients& c) const;

    // These are about one part of the rows.
    void prepare(size_t part, bool deflated);
    void measure(size_t part, bool deflated);
    void turn_affinely(size_t part, const Coefficients& c);
    void turn(size_t part, double beta, const Coefficients& c);
    void advance(size_t part, double step, const Coefficients& c);
    void finish(size_t part, double step, const Coefficients& all, Points& out) const;

    double total(double Sums::*sum) const;
    Coefficients total_moments() const;
    AffineFields::System total_system() const;
    void allocate();

    std::vector<Real> m_fields, m_p_fields;  ///< n x 4: F, P F
    std::vector<double> m_solution;  ///< n x 4: rounded, it would not be what the residual is of
    std::vector<Real> m_direction, m_p_direction;  ///< n x 4
    ContactProduct<Real> m_contacts;
    std::array<Sums, Crew::parts> m_sums;
    bool m_deflated = false;
};

}  // namespace cloth
