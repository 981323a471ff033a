#pragma once

#include "collision/proximity/ridge_contacts.h"
#include "collision/response/contact_projection.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/self_contact_projection.h"
#include "gnn/stepper.h"

namespace cloth {

/// A fixed number of quasi-Newton iterations per step, from the projected extrapolation: nearest
/// surface points, guess, iterations, and a contact projection that leaves nothing inside an
/// obstacle.
///
///     QuasiNewtonSettings settings;
///     settings.iterations = 5;
///     QuasiNewtonStepper stepper(garment, settings);
///     StepReport report = stepper.step(boundary, 1.0 / 30.0, state);
///
/// Accepts any time step; a change of it costs one factorisation.
class QuasiNewtonStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`.
    /// @throws ArgumentError if a setting is out of range
    QuasiNewtonStepper(const Garment& garment, const QuasiNewtonSettings& settings,
                       const ProximitySettings& proximity = {});

    /// "quasi-newton-K" with exactly K iterations, "quasi-newton" with as many as it takes; with
    /// "-bdf2" at the end if that integrates.
    std::string name() const override;
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    const SelfContactProjection& layers() const { return m_layers; }  ///< of the last step
    bool internal_forces(const Points& x, Points& forces) const override {
        m_potential.internal_forces(x, forces);
        return true;
    }

 private:
    void find_contacts(const Boundary& boundary, const ClothState& state);
    void resolve(const Boundary& boundary, StepReport& report);

    const Garment* m_garment;
    IncrementalPotential m_potential;
    TimeIntegration m_time;
    QuasiNewton m_solver;
    Proximity m_proximity;
    RidgeFinder m_ridges;
    ContactProjection m_resolver;
    SelfContactProjection m_layers;
    SurfaceContacts m_contacts;
    Points m_x, m_v;  ///< |V| x 3: the new positions and velocities
};

}  // namespace cloth
