#pragma once

#include "data/body/skinning.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/train/loss.h"

namespace cloth {

/// The loss of a garment's positions in three consecutive frames: the energy of the step that ends
/// with the last one, as that of any other solver.
class SkinningLoss {
 public:
    /// Keeps a reference to `garment`.
    SkinningLoss(const Garment& garment, double dt);

    /// @param kind          energy or log
    /// @param body          from t to t + dt
    /// @param before, now, next  |V| x 3 (m): at t - dt, t and t + dt
    void evaluate(LossKind kind, const Obstacle& body, double contact_weight, const Points& before,
                  const Points& now, const Points& next, LossValue& loss);

    EnergyTerms terms(const Points& x) const { return m_potential.terms(x); }  ///< of that step

 private:
    double m_dt;
    Proximity m_proximity;
    IncrementalPotential m_potential;
    Boundary m_boundary;
    SurfaceContacts m_contacts;
};

/// Gradient by the displacements of a skinned garment, of one by its posed places.
/// @param gradient  |V| x 3
Points unskinned(const Points& gradient, const SkinWeights& weights,
                 const std::vector<SkinMatrix>& matrices);

}  // namespace cloth
