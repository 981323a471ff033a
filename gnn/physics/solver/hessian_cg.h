#pragma once

#include <array>
#include <vector>

#include "gnn/physics/solver/contact_product.h"
#include "gnn/physics/solver/fabric_hessian.h"
#include "gnn/physics/solver/preconditioned_rows.h"

namespace cloth {

/// Conjugate gradients for (H + contact blocks) x = b, H the FabricHessian at a point,
/// preconditioned by P:
///
///     contacts.anticipate(cg.start(factor, b));  // P^-1 b
///     cg.solve(hessian, at, contacts, iterations, x);
///
/// Threads, layout and sums are as in DeflatedCg.
template <class Real>
class HessianCg : public PreconditionedRows<Real> {
 public:
    /// Goes on with the solve that was begun.
    /// @param at  |V| x 3 (m): where H is taken
    void solve(FabricHessian<Real>& hessian, const Points& at, const ContactHessian& contacts,
               int iterations, Points& out);

 private:
    using Base = PreconditionedRows<Real>;
    using Base::for_rows, Base::lanes, Base::m_factor, Base::m_residual, Base::m_step, Base::m_work,
        Base::power_of, Base::sum_rows;

    /// Of one part of the rows.
    struct alignas(64) Sums {
        double power;      ///< r . z
        double curvature;  ///< d . A d
    };

    // All threads of a crew go through these together.
    void iterate(const Crew& crew, FabricHessian<Real>& hessian, const Points& at, int iterations,
                 Points& out);

    // These are about one part of the rows.
    void multiply(size_t part, const FabricHessian<Real>& hessian);
    void advance(size_t part, double step);

    double total(double Sums::*sum) const;
    void allocate();

    std::vector<double> m_solution;            ///< n x 4
    std::vector<Real> m_direction, m_product;  ///< n x 4
    ContactProduct<Real> m_contacts;
    std::array<Sums, Crew::parts> m_sums;
};

}  // namespace cloth
