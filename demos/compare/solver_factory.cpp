#include "demos/compare/solver_factory.h"

#include <optional>

#include "bullet_ext/bodySegments.h"
#include "bullet_ext/bulletClothStepper.h"
#include "data/paths.h"
#include "gnn/model/engine.h"
#include "gnn/model/learned_stepper.h"
#include "gnn/physics/implicit_stepper.h"
#include "gnn/physics/quasi_newton_stepper.h"

namespace cloth {
namespace {

/// The K of "PREFIX" + K, or nothing.
std::optional<int> number_after(const std::string& name, const std::string& prefix) {
    if (name.rfind(prefix, 0) != 0 || name.size() == prefix.size()) return std::nullopt;
    const std::string digits = name.substr(prefix.size());
    if (digits.size() > 4 || digits.find_first_not_of("0123456789") != std::string::npos)
        return std::nullopt;
    return std::stoi(digits);
}

std::unique_ptr<Stepper> make_bullet(const std::string& name, const ComparisonScene& scene) {
    BulletClothSettings settings = BulletClothSettings::shipped();
    if (const auto iterations = number_after(name, "bullet-"))
        settings = BulletClothSettings::shipped(*iterations);
    if (name == "bullet-fine") settings = BulletClothSettings::fine();
    const Body& body = scene.body().body();
    return std::make_unique<BulletClothStepper>(
        scene.garment(), settings, segment_body(body.rest_mesh(), body.dominant_joint()));
}

std::unique_ptr<Stepper> make_network(const std::string& name, const ComparisonScene& scene,
                                      const CompareOptions& options) {
    const size_t plus = name.find('+');
    const std::string variant = name.substr(0, plus);
    LearnedStepperSettings settings;
    if (plus != std::string::npos) {
        const auto refine = number_after(name, variant + "+");
        if (!refine) throw UsageError("solver " + name + ": write NAME+K, such as fast+2");
        settings.refine = *refine;
    }
    const std::string file = options.weights.empty()
                                 ? asset_path("weights/" + variant + ".safetensors")
                                 : options.weights + "/" + variant + ".safetensors";
    auto weights = std::make_shared<const Weights>(Weights::load(file));
    return std::make_unique<LearnedStepper>(
        scene.garment(), std::make_shared<Engine>(weights, EngineSettings{options.threads}),
        settings);
}

}  // namespace

std::unique_ptr<Stepper> make_solver(const std::string& name, const ComparisonScene& scene,
                                     const CompareOptions& options) {
    if (name.rfind("bullet", 0) == 0) {
        const bool known =
            name == "bullet" || name == "bullet-fine" || number_after(name, "bullet-").has_value();
        if (!known) throw UsageError("solver " + name + ": choose bullet, bullet-fine or bullet-K");
        return make_bullet(name, scene);
    }
    if (name == "reference") return std::make_unique<ImplicitStepper>(scene.garment());
    if (name.rfind("quasi-newton", 0) == 0) {
        const auto iterations = number_after(name, "quasi-newton-");
        if (!iterations) throw UsageError("solver " + name + ": write quasi-newton-K");
        QuasiNewtonSettings settings;
        settings.iterations = *iterations;
        return std::make_unique<QuasiNewtonStepper>(scene.garment(), settings);
    }
    return make_network(name, scene, options);
}

}  // namespace cloth
