#include "gnn/skinning/skinning_stepper.h"

#include <cmath>
#include <utility>

#include "data/core/check_range.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {

SkinningStepper::SkinningStepper(const Garment& garment,
                                 std::shared_ptr<const SkinningWeights> weights,
                                 std::shared_ptr<const Body> body,
                                 const SkinningStepperSettings& settings)
    : m_garment(&garment),
      m_settings(settings),
      m_predictor(garment, std::move(weights), std::move(body)),
      m_proximity(settings.proximity),
      m_projection(garment) {
    check_range("SkinningStepperSettings.safety_distance", settings.safety_distance, 0.0, 1e-3);
}

StepReport SkinningStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_garment, state, boundary, dt) || std::abs(dt - fixed_dt()) > 1e-6)
        return StepReport::failed();
    StepReport report;
    Stopwatch watch;
    if (!m_predictor.predict(boundary, m_x)) return StepReport::failed();
    place_pins(*m_garment, boundary, m_x);
    report.times.solve = watch.lap();
    if (m_settings.project && m_x.allFinite()) {
        const ResolveReport resolved = m_projection.resolve(
            m_proximity, boundary, m_settings.safety_distance, m_x, m_contacts);
        report.max_penetration = resolved.deepest_after();
        report.max_entry = resolved.max_depth_before;
        report.times.contact = watch.lap();
    }
    m_v = (m_x - state.x) / dt;
    if (!m_x.allFinite() || !m_v.allFinite()) return StepReport::failed();
    state.x = m_x;
    state.v = m_v;
    state.stick = {};
    state.time += dt;
    return report;
}

}  // namespace cloth
