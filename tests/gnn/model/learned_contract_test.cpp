// The contract of all steppers, kept by the learned ones: the engine with the committed weights.

#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"
#include "tests/gnn/stepper_contract.h"

namespace cloth::test {
namespace {

StepperCase learned(const std::string& variant, int refine) {
    const auto make = [variant, refine](const Garment& garment) {
        const auto weights = std::make_shared<const EngineWeights>(
            Weights::load(asset_path("weights/" + variant + ".safetensors")));
        return make_cloth(garment, std::make_shared<Engine>(weights),
                          ClothStepperSettings::plain(IterationLimits::exactly(refine)));
    };
    const std::string learnt = "the network only comes near it, and refinement is bounded";
    std::map<Promise, std::string> exceptions = {
        {Promise::free_fall, learnt},
        {Promise::rest, learnt},
        {Promise::yaw_equivariance, "learned from turned scenes, not built in"}};
    if (ModelConfig::variant_named(variant).sampled_edges > 0)
        exceptions[Promise::permutation_invariance] =
            "the sampling schedule follows the order of vertices";
    // the features are single precision
    return {variant + std::to_string(refine), make, 1e-4, exceptions};
}

/// As shipped: refined and guarded.
StepperCase shipped() {
    StepperCase result = learned("fast", 10);
    result.name = "smallShipped";
    result.make = [](const Garment& garment) {
        ClothSettings settings;
        settings.weights = std::make_shared<const EngineWeights>(
            Weights::load(asset_path("weights/small.safetensors")));
        return make_cloth(garment, settings);
    };
    return result;
}

INSTANTIATE_TEST_SUITE_P(Learned, StepperContract,
                         ::testing::Values(learned("fast", 0), learned("fast", 10),
                                           learned("baseline", 10), shipped()),
                         case_name);

}  // namespace
}  // namespace cloth::test
