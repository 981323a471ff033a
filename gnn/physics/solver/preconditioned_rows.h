#pragma once

#include <vector>

#include "gnn/physics/energy/lanes.h"
#include "gnn/physics/solver/supernodal_cholesky.h"

namespace cloth {

/// What conjugate gradients that P preconditions have in common: the vectors, in the layout and the
/// precision of the factor, the first solve with P, and the ways through the rows of a part.
template <class Real>
class PreconditionedRows {
 public:
    using Factor = SupernodalCholesky<Real>;

    /// Begins a solve. @return  P^-1 b (n x 3)
    const Points& start(const Factor& factor, const Points& b);

 protected:
    size_t lanes() const { return 4 * static_cast<size_t>(m_factor->size()); }

    // These are about one part of the rows.
    template <class Visit>
    void for_rows(size_t part, const Visit& visit) const {
        for (const auto& rows : m_factor->rows(part))
            for (int row = rows.begin; row < rows.end; ++row) visit(static_cast<size_t>(row));
    }
    /// Of a term for each row, in double precision; two sums, since one has to wait for each
    /// addition.
    template <class Term>
    double sum_rows(size_t part, const Term& term) const {
        DoubleLanes even = {}, odd = {};
        for (const auto& rows : m_factor->rows(part)) {
            auto row = static_cast<size_t>(rows.begin);
            const auto end = static_cast<size_t>(rows.end);
            for (; row + 1 < end; row += 2) {
                even += widened(term(row));
                odd += widened(term(row + 1));
            }
            if (row < end) even += widened(term(row));
        }
        return sum(DoubleLanes(even + odd));
    }
    /// r . P^-1 r, after a solve with P.
    double power_of(size_t part) const {
        return sum_rows(part, [&](size_t row) -> Lanes<Real> {
            return load(m_residual.data() + 4 * row) * load(m_work.data() + 4 * row);
        });
    }

    const Factor* m_factor = nullptr;
    Points m_step;                 ///< n x 3
    std::vector<Real> m_residual;  ///< n x 4: b at first
    std::vector<Real> m_work;      ///< work_rows() x 4: P^-1 b at first

 private:
    void take(size_t part, const Points& b);
};

}  // namespace cloth
