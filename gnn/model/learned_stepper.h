#pragma once

#include <memory>
#include <string>

#include "collision/proximity/ridge_contacts.h"
#include "collision/response/contact_projection.h"
#include "gnn/model/predictor.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/self_contact_projection.h"
#include "gnn/stepper.h"

namespace cloth {

/// How much of the quasi-Newton step follows the network.
///
///     settings.refine = Refinement();                    // the default: error control
///     settings.refine = Refinement::off();               // the paper's method
///     settings.refine = 10;                              // a fixed number of iterations
///     settings.refine = Refinement::until(1.0, 30);      // until the residual is below 1, or 30
struct Refinement {
    int iterations = 100;  ///< at most, 0 to 1000; 0: off, the network's answer is taken as it is.
                           ///< Off blows up in long motions; 2 lose a T-shirt in a jump
    int least = 10;        ///< but not fewer than these
    double least_gain = 3e-3;  ///< stop when StepReport::gain is below this (m), 0 to 1; 0: never
    double tolerance = 0.0;    ///< or StepReport::residual is at this, 0 to 1e6

    /// Ten iterations, and up to a hundred for as long as five of them gain 3 mm.
    Refinement() = default;
    Refinement(int count) : iterations(count), least(count), least_gain(0.0) {}
    static Refinement off() { return Refinement(0); }
    static Refinement until(double tolerance, int at_most) {
        Refinement refinement(at_most);
        refinement.least = 0;
        refinement.tolerance = tolerance;
        return refinement;
    }
};

struct LearnedStepperSettings {
    Refinement refine;
    double safety_distance = 0.0;  ///< vertices that end nearer to an obstacle are pushed out to
                                   ///< this distance (m), 0 to 1e-3
    PotentialSettings potential;
    ProximitySettings proximity;
};

/// The learned step: projected extrapolation, one evaluation of the network, a few quasi-Newton
/// iterations on the same energy as its safeguard, and what is still inside an obstacle is pushed
/// out.
///
///     LearnedStepper stepper(garment, predictor, {});
///     StepReport report = stepper.step(boundary, stepper.fixed_dt(), state);
///
/// With refinement the network's answer is checked before it is used: if it is not finite, or of
/// higher energy than the guess it was added to, the iterations start from the guess;
/// last_step_fell_back() tells. StepReport::residual, iterations and converged (the tolerance was
/// met) say what the refinement reached. Without refinement only an answer that is not finite is
/// replaced by the guess.
class LearnedStepper : public Stepper {
 public:
    LearnedStepper(const Garment& garment, std::shared_ptr<Predictor> predictor,
                   LearnedStepperSettings settings = {});

    /// The network's variant, such as "fast"; with a fixed number of iterations "fast+10", with a
    /// tolerance alone "fast+1e-02".
    std::string name() const override;
    double fixed_dt() const override { return m_predictor->config().dt; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool internal_forces(const Points& x, Points& forces) const override {
        m_potential.internal_forces(x, forces);
        return true;
    }

    bool last_step_fell_back() const { return m_fell_back; }

    /// The network's position alone (|V| x 3, m), before refinement, of the last step.
    const Points& prediction() const { return m_prediction; }

 private:
    void predict(const Boundary& boundary, double dt, const ClothState& state, StepReport& report);
    void check_prediction();
    void refine(StepReport& report);
    bool accept(const Boundary& boundary, double dt, ClothState& state, StepReport& report);

    const Garment* m_garment;
    std::shared_ptr<Predictor> m_predictor;
    LearnedStepperSettings m_settings;
    ClothGraph m_graph;
    Proximity m_proximity;
    RidgeFinder m_ridges;
    ContactProjection m_resolver;
    SelfContactProjection m_layers;
    IncrementalPotential m_potential;
    TimeIntegration m_time;
    QuasiNewton m_solver;
    FeatureBuilder m_builder;
    SurfaceContacts m_contacts, m_resolved;
    Features m_features;
    Points m_guess, m_output, m_prediction, m_x, m_v;
    bool m_fell_back = false;
};

}  // namespace cloth
