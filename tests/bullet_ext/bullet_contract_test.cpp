// What Bullet's own solver keeps of the promises of every Stepper.

#include "bullet_ext/bulletClothStepper.h"
#include "tests/gnn/stepper_contract.h"

namespace cloth::test {
namespace {

StepperCase bullet(const std::string& name, const BulletClothSettings& settings) {
    const auto make = [settings](const Garment& garment) {
        return std::make_unique<BulletClothStepper>(garment, settings);
    };
    StepperCase result{name, make, 1e-4, {}};
    result.exceptions = {
        {Promise::free_fall, "it falls in sub-steps, by another closed form (tested on its own)"},
        {Promise::translation_equivariance, "floats: far from the origin contacts switch earlier"},
        {Promise::permutation_invariance, "it relaxes links one after the other"},
        {Promise::any_time_step, "a time step is cut into sub-steps of which none is tiny"},
        {Promise::stays_outside, "it lets cloth sink in by millimetres"},
    };
    return result;
}

INSTANTIATE_TEST_SUITE_P(Bullet, StepperContract,
                         ::testing::Values(bullet("BulletShipped", BulletClothSettings::shipped()),
                                           bullet("BulletFine", BulletClothSettings::fine())),
                         case_name);

}  // namespace
}  // namespace cloth::test
