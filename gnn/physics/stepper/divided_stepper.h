#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gnn/physics/stepper/boundary_part.h"
#include "gnn/stepper.h"

namespace cloth {

/// Takes each step in equal parts, each of them a whole step of another stepper: how a network for
/// 1/60 s steps a world, or the proxy of a garment, at 1/30 s.
///
///     auto steps = std::make_unique<DividedStepper>(proxy, std::move(of_a_60th), 2);
///     EmbeddedStepper stepper(shirt, proxy_garment, std::move(steps));
///
/// Obstacles, goals and pins move evenly during the step. Surfaces at the parts' ends are this
/// stepper's own, not those that a world shares. ClothState has the mean velocity over a step. A
/// state whose positions are those that were returned last, or those from which that step began,
/// goes on with its velocity (which others may have changed) and what the last part's differed from
/// the mean by; any other state with its velocity alone.
///
/// Reports: iterations and times are summed; penetration, residual, goals and tangles are those at
/// the end of the step; entry and what was tunnelled through the worst of the parts.
/// StepReport::substeps is the largest of the parts' own. A part that fails fails the step.
class DividedStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`, that of `inner`.
    /// @param parts  of a step, 1 to 64
    /// @throws ArgumentError if `inner` is null or `parts` out of range
    DividedStepper(const Garment& garment, std::unique_ptr<Stepper> inner, int parts);

    /// The other stepper's, and "xN" after it.
    std::string name() const override;
    double fixed_dt() const override { return m_parts * m_inner->fixed_dt(); }
    bool accepts_any_dt() const override { return m_inner->accepts_any_dt(); }
    void prepare(double dt) override { m_inner->prepare(dt / m_parts); }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    void moved(const Points& before, const Points& after, const Eigen::Matrix3d& turn) override;
    bool is_independent() const override { return m_inner->is_independent(); }
    /// Each part has an equal share.
    bool set_max_ms(double ms) override { return m_inner->set_max_ms(ms / m_parts); }
    bool set_max_iterations(int most) override { return m_inner->set_max_iterations(most); }
    bool set_most_residual(double most) override { return m_inner->set_most_residual(most); }
    bool set_surface_projection(bool on) override { return m_inner->set_surface_projection(on); }
    /// Where x is the end of the last step, the mean of those at the ends of its parts.
    bool internal_forces(const Points& x, Points& forces) const override;
    std::optional<double> internal_energy(const Points& x) const override {
        return m_inner->internal_energy(x);
    }
    const std::vector<LimbSet>& ignored_limbs() const override { return m_inner->ignored_limbs(); }

 private:
    struct Lag {
        Points x;  ///< |V| x 3 (m): what was returned
        Points v;  ///< |V| x 3 (m/s): velocity of the last part - mean velocity
    };

    const Garment* m_garment;
    std::unique_ptr<Stepper> m_inner;
    int m_parts;
    BoundaryPart m_part;
    ClothState m_state;               ///< during a step
    std::vector<Points> m_part_ends;  ///< of the last step, but for the last part's (m)
    std::vector<Points> m_next_ends;  ///< of the step that is being taken
    Lag m_lag, m_lag_before;          ///< of the last step, and where it began
};

}  // namespace cloth
