#pragma once

#include <memory>
#include <string>

#include "collision/ccd/tunnelling.h"
#include "gnn/stepper.h"

namespace cloth {

/// Another stepper, whose report also tells what the garment went through (StepReport::tunnelled).
class WatchedStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`.
    /// @param least_motion  steps in which nothing near the garment moves farther (m, see
    ///                      relative_motion()) are not looked at
    /// @throws ArgumentError if the stepper is null
    WatchedStepper(const Garment& garment, std::unique_ptr<Stepper> inner, double least_motion);

    std::string name() const override { return m_inner->name(); }
    double fixed_dt() const override { return m_inner->fixed_dt(); }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool internal_forces(const Points& x, Points& forces) const override {
        return m_inner->internal_forces(x, forces);
    }

 private:
    const Garment* m_garment;
    std::unique_ptr<Stepper> m_inner;
    double m_least_motion;
    TunnellingDetector m_tunnelling;
    Points m_before;  ///< |V| x 3 (m)
};

}  // namespace cloth
