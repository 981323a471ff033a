#pragma once

#include <map>
#include <memory>

#include "collision/proximity/limb_overlap.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/relative_motion.h"
#include "gnn/physics/stepper/substepped_stepper.h"

namespace cloth {

struct GuardSettings {
    /// Steps in which an obstacle near the garment, or a pin, moves farther than this (m, relative
    /// to the garment) are cut, 0.01 to 1. Contacts are found at the start of a step within the
    /// proximity's radius: what comes from farther away would pass through.
    double max_motion = 0.1;
    /// Steps that leave a vertex deeper inside an obstacle than this (m, before contact projection)
    /// went past a surface: they are taken again in sub-steps of `fine_motion`, 1e-3 to 0.1.
    double max_entry = 0.01;
    double fine_motion = 0.04;  ///< motion in such a sub-step at most (m), 0.01 to 1
    /// Steps of more motion than this (m, 5e-3 to 1) are searched for solids that the garment went
    /// through on the way, see TunnellingDetector. They are taken again in sub-steps of
    /// `tunnelling_motion`, or of half as much motion as the solid is thick: in these the nearest
    /// surface is the one that the cloth came from.
    double watch_motion = 0.02;
    double tunnelling_motion = 0.01;                                      ///< (m), 1e-3 to 1
    int max_substeps = 16;                                                ///< 1 to 64
    QuasiNewtonSettings solver = QuasiNewtonSettings::controlled(5, 50);  ///< of a sub-step
};

/// Another stepper wherever it can be trusted, the quasi-Newton solver in sub-steps elsewhere:
/// where obstacles or pins move too fast for one step, where the step failed, and where it went
/// past a surface or through a solid, such as a hand that swings through a hem. A jump of the body
/// by metres (teleport, cut in an animation) is cut into max_substeps parts like any fast motion.
///
/// Limbs of a body that pass through each other are handled as LimbOverlap says, for any stepper.
///
///     GuardedStepper stepper(garment, std::make_unique<LearnedStepper>(garment, engine));
///
/// Steps that need no guarding are those of the inner stepper, bit for bit.
class GuardedStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`. @throws ArgumentError if a setting is out of range
    GuardedStepper(const Garment& garment, std::unique_ptr<Stepper> inner,
                   GuardSettings settings = {});

    /// The inner stepper's.
    std::string name() const override { return m_inner->name(); }
    double fixed_dt() const override { return m_inner->fixed_dt(); }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool internal_forces(const Points& x, Points& forces) const override {
        return m_inner->internal_forces(x, forces);
    }

    /// Limbs that each vertex ignored in the last step (|V|), or empty; see LimbOverlap.
    const std::vector<LimbSet>& ignored_limbs() const { return m_limbs.ignored(); }
    /// Sub-steps of the last step; 1: the inner stepper's.
    int last_substeps() const { return m_last_substeps; }
    /// Steps so far that were not the inner stepper's.
    long guarded_steps() const { return m_guarded_steps; }

 private:
    StepReport guarded_step(const Boundary& boundary, double dt, ClothState& state);
    void report_ignored(const Points& x, StepReport& report);
    StepReport take(int substeps, const Boundary& boundary, double dt, ClothState& state);
    int substeps_for(double motion, double most) const;
    int substeps_after(const StepReport& report, double motion) const;
    void count(int substeps);
    Stepper& fallback(int substeps);

    const Garment* m_garment;
    std::unique_ptr<Stepper> m_inner;
    GuardSettings m_settings;
    std::map<int, std::unique_ptr<SubsteppedStepper>> m_fallbacks;  ///< by number of sub-steps
    LimbOverlap m_limbs;
    ClothState m_before;  ///< from which a step is taken again
    int m_last_substeps = 1;
    long m_guarded_steps = 0;
};

/// The quasi-Newton solver as it should be used: with error control, and guarded.
///
///     btGnnSoftBodySolver solver([](const Garment& garment) {
///         return make_physics_cloth(garment);
///     });
///
/// The sub-steps minimise the potential of `settings`, whatever `guard.solver` holds. Keeps a
/// reference to `garment`. @throws ArgumentError if a setting is out of range
std::unique_ptr<Stepper> make_physics_cloth(
    const Garment& garment, const QuasiNewtonSettings& settings = QuasiNewtonSettings::controlled(),
    const GuardSettings& guard = {});

}  // namespace cloth
