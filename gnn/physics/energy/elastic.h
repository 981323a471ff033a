#pragma once

#include "gnn/physics/energy/bending.h"
#include "gnn/physics/energy/strain.h"

namespace cloth {

/// What the fabric itself costs: strain and bending, on several threads where there is enough of
/// it. Elements are summed up in parts of their own, which depend on the garment alone, so that
/// equal inputs give equal bits for any number of threads.
class ElasticEnergy {
 public:
    struct Terms {
        double strain = 0.0, bending = 0.0;  ///< (J)
    };

    /// Keeps a reference to `garment`.
    explicit ElasticEnergy(const Garment& garment);

    /// @param x  |V| x 3 (m)
    Terms value(const Points& x) const { return {m_strain.value(x), m_bending.value(x)}; }
    /// The gradient replaces what is in `gradient` (|V| x 3, N).
    Terms gradient(const Points& x, Points& gradient) const;
    /// See StrainEnergy::add_hessian().
    void add_hessian(const Points& x, const BlockPattern& pattern, HessianKind kind,
                     double* values) const;

 private:
    StrainEnergy m_strain;
    BendingEnergy m_bending;
    bool m_in_parts;
};

}  // namespace cloth
