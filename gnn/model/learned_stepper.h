#pragma once

#include <memory>
#include <string>

#include "collision/proximity.h"
#include "gnn/model/predictor.h"
#include "gnn/physics/quasi_newton.h"
#include "gnn/stepper.h"

namespace cloth {

struct LearnedStepperSettings {
    int refine = 10;  ///< quasi-Newton iterations after the network, 0 to 100; 0: the paper's
                      ///< method, which blows up in long motions; 2 lose a T-shirt in a jump
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
/// If the network's output is not finite the iterations start from the guess;
/// last_step_fell_back() tells.
class LearnedStepper : public Stepper {
 public:
    LearnedStepper(const Garment& garment, std::shared_ptr<Predictor> predictor,
                   LearnedStepperSettings settings = {});

    /// The network's variant and the iterations, such as "fast+2".
    std::string name() const override;
    double fixed_dt() const override { return m_predictor->config().dt; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;

    bool last_step_fell_back() const { return m_fell_back; }

    /// The network's position alone (|V| x 3, m), before refinement, of the last step.
    const Points& prediction() const { return m_prediction; }

 private:
    void predict(const Boundary& boundary, double dt, const ClothState& state, StepReport& report);
    void refine(StepReport& report);
    bool accept(const Boundary& boundary, double dt, ClothState& state, StepReport& report);

    const Garment* m_garment;
    std::shared_ptr<Predictor> m_predictor;
    LearnedStepperSettings m_settings;
    ClothGraph m_graph;
    Proximity m_proximity;
    IncrementalPotential m_potential;
    QuasiNewton m_solver;
    FeatureBuilder m_builder;
    SurfaceContacts m_contacts, m_resolved;
    Features m_features;
    Points m_guess, m_output, m_prediction, m_x;
    bool m_fell_back = false;
};

}  // namespace cloth
