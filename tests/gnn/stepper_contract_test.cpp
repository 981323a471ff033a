#include "tests/gnn/stepper_contract.h"

#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"

namespace cloth::test {
namespace {

StepperCase quasi_newton(int iterations) {
    const auto make = [iterations](const Garment& garment) {
        return std::make_unique<ClothStepper>(
            garment, ClothStepperSettings::plain(IterationLimits::exactly(iterations)));
    };
    return {"QuasiNewton" + std::to_string(iterations), make, 1e-6, {}};
}

StepperCase bdf2() {
    const auto make = [](const Garment& garment) {
        ClothStepperSettings settings = ClothStepperSettings::plain();
        settings.step.potential.integrator = Integrator::bdf2;
        return std::make_unique<ClothStepper>(garment, settings);
    };
    return {"Bdf2",
            make,
            1e-6,
            {{Promise::free_fall, "it falls by BDF2's closed form (tested on its own)"}}};
}

StepperCase reference() {
    const auto make = [](const Garment& garment) {
        return std::make_unique<ClothStepper>(garment, ClothStepperSettings::reference());
    };
    return {"Reference", make, 1e-5, {}};
}

StepperCase xpbd(int substeps) {
    const auto make = [substeps](const Garment& garment) {
        XpbdSettings settings;
        settings.substeps = substeps;
        return std::make_unique<XpbdStepper>(garment, settings);
    };
    StepperCase result{"Xpbd" + std::to_string(substeps), make, 1e-7, {}};
    result.exceptions = {
        {Promise::permutation_invariance, "it relaxes springs one after the other"}};
    return result;
}

StepperCase substepped(int substeps) {
    const auto make = [substeps](const Garment& garment) {
        ClothStepperSettings settings = ClothStepperSettings::plain(IterationLimits::exactly(5));
        settings.substeps = substeps;
        return std::make_unique<ClothStepper>(garment, settings);
    };
    StepperCase result{"Substepped" + std::to_string(substeps), make, 1e-7, {}};
    result.exceptions = {
        {Promise::free_fall, "it falls in sub-steps, by another closed form (tested on its own)"}};
    return result;
}

StepperCase small_steps(const std::string& name, const StepSettings& step, double tolerance) {
    const auto make = [step](const Garment& garment) {
        ClothStepperSettings settings;
        settings.step = step;
        return std::make_unique<ClothStepper>(garment, settings);
    };
    StepperCase result{name, make, tolerance, {}};
    result.exceptions = {{Promise::free_fall,
                          "it falls in small steps, by another closed form (tested on its own)"}};
    return result;
}

// Conjugate gradients that end early amplify rounding where contact is stiff, tenfold from one
// iteration to the next; twenty Newton steps converge all the same.
INSTANTIATE_TEST_SUITE_P(Physics, StepperContract,
                         ::testing::Values(reference(), quasi_newton(1), quasi_newton(5),
                                           quasi_newton(20), bdf2(), substepped(4),
                                           small_steps("SmallSteps", StepSettings::in_small_steps(),
                                                       1e-6),
                                           small_steps("NewtonInSmallSteps",
                                                       StepSettings::newton_in_small_steps(), 5e-4),
                                           xpbd(1), xpbd(20), xpbd(100)),
                         case_name);

}  // namespace
}  // namespace cloth::test
