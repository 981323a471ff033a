#pragma once

#include "collision/proximity/ridge_contacts.h"
#include "collision/response/contact_projection.h"
#include "gnn/physics/solver/newton.h"
#include "gnn/physics/stepper/self_contact_projection.h"
#include "gnn/stepper.h"

namespace cloth {

struct NewtonStepperSettings : NewtonSettings {
    PotentialSettings potential;
    ProximitySettings proximity;
    /// How often the nearest surface points are found anew for the minimum and the minimisation
    /// goes on with them, 0 to 10. 0 minimises the energy as every other stepper does, with the
    /// points that were nearest at t; more follow cloth that slides past the end of a face.
    int contact_updates = 0;
    /// Vertices that end closer than this to an obstacle (m), because they left the plane of their
    /// contact, are moved to this distance; negative: left where the minimum put them.
    double safety_distance = 5e-4;
};

/// The reference: one implicit step minimised by Newton's method from the projected linear
/// extrapolation, or from x_t where the extrapolation's energy is not finite. (Starting from the
/// lower of both needs as many iterations, and where the iterations end before the minimum, cloth
/// that starts from x_t hangs back.)
///
///     NewtonStepper reference(garment);
///     StepReport report = reference.step(boundary, 1.0 / 30.0, state);
///     if (!report.converged) { ... report.residual tells how far it got ... }
///
/// Accepts any time step. Slack cloth in contact may not reach the tolerance within the iterations.
class NewtonStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`.
    /// @throws ArgumentError if a setting is out of range
    explicit NewtonStepper(const Garment& garment, const NewtonStepperSettings& settings = {});

    std::string name() const override { return "reference"; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool internal_forces(const Points& x, Points& forces) const override {
        m_potential.internal_forces(x, forces);
        return true;
    }

 private:
    void find_contacts(const Boundary& boundary, const Points& x, StepEnd end);
    void choose_start(const Boundary& boundary, const ClothState& state, double dt);
    bool minimise(const Boundary& boundary, const ClothState& state, double dt, StepReport& report);
    void finish(const Boundary& boundary, StepReport& report);

    const Garment* m_garment;
    NewtonStepperSettings m_settings;
    IncrementalPotential m_potential;
    TimeIntegration m_time;
    Newton m_newton;
    Proximity m_proximity;
    RidgeFinder m_ridges;
    ContactProjection m_resolver;
    SelfContactProjection m_layers;
    SurfaceContacts m_contacts;
    VectorX m_distance;
    Points m_x, m_v;  ///< |V| x 3
};

}  // namespace cloth
