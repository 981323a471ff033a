#pragma once

#include <memory>
#include <string>

#include "collision/proximity/proximity.h"
#include "collision/response/contact_projection.h"
#include "gnn/skinning/skinning_predictor.h"
#include "gnn/stepper.h"

namespace cloth {

struct SkinningStepperSettings {
    bool project = true;  ///< contact projection, as other solvers have it: nothing ends inside
                          ///< the body. false: the network's answer as it is
    double safety_distance = 5e-4;  ///< of vertices that are moved out (m), 0 to 1e-3
    ProximitySettings proximity;
};

/// A garment-specific skinning network as a solver: a fraction of the work of any other, for one
/// garment on one body.
///
///     SkinningStepper stepper(garment, weights, body);
///     StepReport report = stepper.step(boundary, stepper.fixed_dt(), state);
///
/// The answer depends on the poses of the body, not on the state of the cloth; velocities are what
/// follows from the two. So of the contract of a Stepper it keeps: finite output, failed steps that
/// change nothing, and equal bits for the same steps in the same order (the poses of earlier steps
/// are its own; after a jump of the body, or of the animation, it takes the body to have stood
/// still). It does not promise
///
/// - free fall, or anything else without the body: a step without it fails;
/// - another body, or another shape of it: the step fails;
/// - pins: they are put on their targets, but their neighbours do not follow;
/// - other time steps than fixed_dt(): the step fails;
/// - contact with anything but the body: what else the cloth meets it is pushed out of, with
///   `project`, but does not react to;
/// - another fabric, wind, goals, self-contact: they are not looked at.
class SkinningStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`.
    /// @throws ArgumentError as SkinningPredictor does, or if a setting is out of range
    SkinningStepper(const Garment& garment, std::shared_ptr<const SkinningWeights> weights,
                    std::shared_ptr<const Body> body, const SkinningStepperSettings& settings = {});

    /// "skinning", or "skinning-raw" without projection.
    std::string name() const override { return m_settings.project ? "skinning" : "skinning-raw"; }
    double fixed_dt() const override { return m_predictor.config().dt; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool is_independent() const override { return true; }
    bool set_surface_projection(bool on) override {
        m_projection.set_surface(on);
        return true;
    }

 private:
    const Garment* m_garment;
    SkinningStepperSettings m_settings;
    SkinningPredictor m_predictor;
    Proximity m_proximity;
    ContactProjection m_projection;
    SurfaceContacts m_contacts;
    Points m_x, m_v;
};

}  // namespace cloth
