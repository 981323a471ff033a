#pragma once

#include <vector>

#include "gnn/physics/energy/self_contact.h"
#include "gnn/physics/xpbd/distance_constraints.h"

namespace cloth {

/// The self-contact of a garment in a step with substeps: pairs of elements, found once per step,
/// that are held apart as positions.
class SelfContactPlanes {
 public:
    /// Off, and without cost, if the settings say so.
    /// @throws ArgumentError if a setting is out of range
    SelfContactPlanes(const Garment& garment, const SelfContactSettings& settings);

    /// @param unrepelled  see SelfContactEnergy::begin_step()
    void begin_step(const ClothState& state, double dt, const std::vector<char>& unrepelled) {
        m_energy.begin_step(state, dt, unrepelled);
    }

    /// Moves pairs that are nearer than the thickness, or than at t where that is less, apart
    /// again, one after the other, and takes as much of their slip along each other as friction of
    /// that push allows. Keeps linear momentum; pinned vertices stay.
    /// @param before  |V| x 4 (m): positions at the start of the substep
    void project(const PaddedPoints& before, PaddedPoints& x) const;

 private:
    SelfContactEnergy m_energy;
    VectorX m_inverse_masses;  ///< |V| (1/kg), 0 for pins
};

}  // namespace cloth
