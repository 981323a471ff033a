#pragma once

#include <memory>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::test {

/// A stepper with its own time step; as learned ones, it may take others too.
class Ticking : public Stepper {
 public:
    Ticking(std::unique_ptr<Stepper> inner, double dt, bool accepts_any = false)
        : m_inner(std::move(inner)), m_dt(dt), m_accepts_any(accepts_any) {}
    std::string name() const override { return m_inner->name(); }
    double fixed_dt() const override { return m_dt; }
    bool accepts_any_dt() const override { return m_accepts_any; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override {
        return m_inner->step(boundary, dt, state);
    }
    bool internal_forces(const Points& x, Points& forces) const override {
        return m_inner->internal_forces(x, forces);
    }
    std::optional<double> internal_energy(const Points& x) const override {
        return m_inner->internal_energy(x);
    }

 private:
    std::unique_ptr<Stepper> m_inner;
    double m_dt;
    bool m_accepts_any;
};

/// Quasi-Newton steps at the world's rate, or at a rate of their own if fixed_dt is not zero.
inline StepperFactory quasi_newton(double fixed_dt = 0.0, int iterations = 15) {
    return [=](const Garment& garment) -> std::unique_ptr<Stepper> {
        auto stepper = std::make_unique<ClothStepper>(
            garment, ClothStepperSettings::plain(IterationLimits::exactly(iterations)));
        if (fixed_dt == 0.0) return stepper;
        return std::make_unique<Ticking>(std::move(stepper), fixed_dt);
    };
}

/// A fabric that few iterations hold, and Coulomb's friction alone: for tests of other things.
inline btGnnSolverSettings soft_cotton() {
    btGnnSolverSettings settings;
    settings.fabric = Fabric::soft_cotton();
    settings.friction = btGnnFriction::coulomb;
    return settings;
}

}  // namespace cloth::test
