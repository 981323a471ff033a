#include "tests/fuzz/fuzz_steppers.h"

#include <cmath>
#include <cstring>
#include <exception>

#include "gnn/model/make_cloth.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::test {
namespace {

std::unique_ptr<Stepper> quasi_newton(const Garment& garment) {
    return std::make_unique<ClothStepper>(garment,
                                          ClothStepperSettings::plain(IterationLimits::exactly(3)));
}

std::unique_ptr<Stepper> xpbd(const Garment& garment) {
    XpbdSettings settings;
    settings.substeps = 4;
    return std::make_unique<XpbdStepper>(garment, settings);
}

std::unique_ptr<Stepper> reference(const Garment& garment) {
    ClothStepperSettings settings = ClothStepperSettings::reference();
    settings.step.newton.max_iterations = 2;
    settings.step.contact_updates = 1;
    return std::make_unique<ClothStepper>(garment, settings);
}

std::unique_ptr<Stepper> guarded(const Garment& garment) {
    ClothStepperSettings settings;
    settings.step = StepSettings::in_small_steps(60.0, 2);
    settings.step.potential.integrator = Integrator::bdf2;
    settings.guard.max_substeps = 4;
    settings.guard.iterations = IterationLimits::exactly(2);
    return std::make_unique<ClothStepper>(garment, settings);
}

std::shared_ptr<const EngineWeights> weights(const std::string& variant) {
    ModelConfig config = ModelConfig::variant_named(variant);
    config.steps = 2;
    config.width = 16;
    return std::make_shared<const EngineWeights>(random_weights(config));
}

std::unique_ptr<Stepper> network_alone(const Garment& garment) {
    static const auto baseline = weights("baseline");
    return make_cloth(garment, std::make_shared<Engine>(baseline),
                      ClothStepperSettings::plain(IterationLimits::none()));
}

std::unique_ptr<Stepper> learned(const Garment& garment) {
    static const auto fast = weights("fast");
    ClothSettings settings;
    settings.weights = fast;
    settings.guard.max_substeps = 2;
    return make_cloth(garment, settings);
}

bool same_bits(const Points& a, const Points& b) {
    if (a.rows() != b.rows()) return false;
    const size_t bytes = sizeof(double) * static_cast<size_t>(a.size());
    return bytes == 0 || std::memcmp(a.data(), b.data(), bytes) == 0;
}

bool pins_have_landed(const Garment& garment, const Boundary& boundary, const Points& x) {
    for (size_t k = 0; k < garment.pins().size(); ++k)
        if (x.row(garment.pins()[k]) != boundary.pin_targets.row(static_cast<Eigen::Index>(k)))
            return false;
    return true;
}

}  // namespace

const std::vector<StepperKind>& stepper_kinds() {
    static const std::vector<StepperKind> kinds = {
        {"quasi-newton", quasi_newton}, {"xpbd", xpbd},
        {"reference", reference},       {"guarded", guarded},
        {"network", network_alone},     {"learned", learned}};
    return kinds;
}

bool same_bits(const ClothState& a, const ClothState& b) {
    return same_bits(a.x, b.x) && same_bits(a.v, b.v) &&
           std::memcmp(&a.time, &b.time, sizeof a.time) == 0;
}

std::string broken_promise(const Garment& garment, const Boundary& boundary,
                           const StepReport& report, const ClothState& before,
                           const ClothState& after) {
    if (!report.finite)
        return same_bits(before, after) ? "" : "the step failed and the state has changed";
    if (after.x.rows() != before.x.rows() || after.v.rows() != before.x.rows())
        return "the state has another size";
    if (!after.x.allFinite() || !after.v.allFinite()) return "the state is not finite";
    if (!(report.max_penetration >= 0.0)) return "the penetration is negative or not a number";
    return pins_have_landed(garment, boundary, after.x) ? "" : "a pin is not on its target";
}

std::string checked_step(Stepper& stepper, const Garment& garment, const Boundary& boundary,
                         double dt, ClothState& state) {
    const ClothState before = state;
    try {
        const StepReport report = stepper.step(boundary, dt, state);
        return broken_promise(garment, boundary, report, before, state);
    } catch (const std::exception& error) {
        return std::string("step() threw: ") + error.what();
    }
}

}  // namespace cloth::test
