#include "demos/compare/solver_factory.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "bullet_ext/bulletClothStepper.h"
#include "data/core/paths.h"
#include "demos/compare/arguments.h"
#include "demos/compare/proxy_solver.h"
#include "gnn/model/engine.h"
#include "gnn/model/make_cloth.h"
#include "gnn/physics/stepper/divided_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "gnn/skinning/skinning_stepper.h"

namespace cloth {
namespace {

bool starts_with(const std::string& name, const std::string& prefix) {
    return name.rfind(prefix, 0) == 0;
}

/// The K of "PREFIX" + K, or nothing.
std::optional<int> number_after(const std::string& name, const std::string& prefix) {
    if (!starts_with(name, prefix) || name.size() == prefix.size()) return std::nullopt;
    const std::string digits = name.substr(prefix.size());
    if (digits.size() > 4 || digits.find_first_not_of("0123456789") != std::string::npos)
        return std::nullopt;
    return std::stoi(digits);
}

/// The same for names that must have one in a range.
int iterations_of(const std::string& name, const std::string& prefix, int lowest, int highest) {
    const std::optional<int> number = number_after(name, prefix);
    if (!number || *number < lowest || *number > highest)
        throw UsageError("solver " + name + ": write " + prefix + "K with K from " +
                         std::to_string(lowest) + " to " + std::to_string(highest));
    return *number;
}

/// Bullet with K iterations and S sub-steps of a frame. The margin is the one that was found to
/// hold a T-shirt: 10 mm with the shipped sub-steps, 4 mm with the fine ones.
BulletClothSettings bullet_settings(const std::string& name, const ComparisonScene& scene) {
    if (name == "bullet") return BulletClothSettings::shipped();
    if (name == "bullet-fine") return BulletClothSettings::fine();
    const size_t cross = name.find('x');
    if (cross == std::string::npos)
        return BulletClothSettings::shipped(iterations_of(name, "bullet-", 2, 100));
    const std::string first = name.substr(0, cross);
    const int iterations = iterations_of(first, "bullet-", 2, 100);
    const int substeps = iterations_of(name, first + "x", 1, 64);
    BulletClothSettings settings =
        substeps < 8 ? BulletClothSettings::shipped() : BulletClothSettings::fine();
    settings.name = name;
    settings.cloth.iterations = iterations;
    settings.substep_dt = scene.frame_time() / substeps;
    return settings;
}

const std::string bdf2 = "-bdf2";

/// The integrator that a name ends with, which is taken off.
Integrator take_integrator(std::string& name) {
    if (name.size() < bdf2.size() || name.substr(name.size() - bdf2.size()) != bdf2)
        return Integrator::backward_euler;
    name.resize(name.size() - bdf2.size());
    return Integrator::bdf2;
}

/// What all solvers of a potential have: an integrator, and what the scene says of limbs and
/// self-contact.
void set_scene(Integrator integrator, const ComparisonScene& scene,
               ClothStepperSettings& settings) {
    settings.step.potential.integrator = integrator;
    settings.step.potential.self_contact = scene.self_contact();
    settings.guard.limbs = scene.has_limbs();
}

std::unique_ptr<Stepper> make_newton(std::string name, const ComparisonScene& scene) {
    ClothStepperSettings settings = ClothStepperSettings::reference();
    set_scene(take_integrator(name), scene, settings);
    if (name != "reference")
        settings.step.newton.max_iterations = iterations_of(name, "newton-", 0, 1000);
    return std::make_unique<ClothStepper>(scene.garment(), settings);
}

std::unique_ptr<Stepper> make_quasi_newton(std::string name, const ComparisonScene& scene) {
    ClothStepperSettings settings;
    const Integrator integrator = take_integrator(name);
    if (name == "quasi-newton") {
        settings.step = StepSettings::whole();
    } else if (name == "default") {  // as they are
    } else if (const auto small = small_steps_named(name)) {
        settings.step = *small;
    } else {
        const size_t cross = name.find('x');
        const std::string first = name.substr(0, cross);
        settings.step = StepSettings::whole(
            IterationLimits::exactly(iterations_of(first, "quasi-newton-", 0, 1000)));
        settings.guard.max_substeps = 1;
        if (cross != std::string::npos) settings.substeps = iterations_of(name, first + "x", 1, 64);
    }
    set_scene(integrator, scene, settings);
    return std::make_unique<ClothStepper>(scene.garment(), settings);
}

/// A stepper that knows of no limbs, told which ones to pass over.
class WithLimbs : public Stepper {
 public:
    explicit WithLimbs(std::unique_ptr<Stepper> inner) : m_inner(std::move(inner)) {}
    std::string name() const override { return m_inner->name(); }
    double fixed_dt() const override { return m_inner->fixed_dt(); }
    bool is_independent() const override { return m_inner->is_independent(); }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override {
        return m_inner->step(m_limbs.filter(boundary, dt, state), dt, state);
    }
    bool set_surface_projection(bool on) override { return m_inner->set_surface_projection(on); }
    bool internal_forces(const Points& x, Points& forces) const override {
        return m_inner->internal_forces(x, forces);
    }
    const std::vector<LimbSet>& ignored_limbs() const override { return m_limbs.ignored(); }

 private:
    std::unique_ptr<Stepper> m_inner;
    LimbOverlap m_limbs;
};

std::unique_ptr<Stepper> make_xpbd(const std::string& name, const ComparisonScene& scene) {
    XpbdSettings settings;
    settings.substeps = iterations_of(name, "xpbd-", 1, 1000);
    settings.self_contact = scene.self_contact();
    auto stepper = std::make_unique<XpbdStepper>(scene.garment(), settings);
    if (!scene.has_limbs()) return stepper;
    return std::make_unique<WithLimbs>(std::move(stepper));
}

std::string weights_folder(const std::string& folder) {
    return folder.empty() ? asset_path("weights") : folder;
}

/// Marks in the names of solvers, which a network's name cannot have.
bool has_mark(const std::string& network) {
    return network.find_first_of("~+@") != std::string::npos;
}

/// A file of that name would be taken for another solver with a proxy, iterations or a limit.
void refuse_file_of(const std::string& name, const std::string& folder) {
    if (folder.empty() || !has_mark(name)) return;
    const std::string file = folder + "/" + name + ".safetensors";
    if (std::filesystem::exists(file))
        throw UsageError("solver " + name +
                         ": ~, + and @ have a meaning in solvers' names; rename " + file);
}

std::unique_ptr<Stepper> make_skinning(const std::string& name, const ComparisonScene& scene,
                                       const SolverSettings& settings) {
    if (name != "skinning" && name != "skinning-raw")
        throw UsageError("solver " + name + ": write skinning or skinning-raw");
    const std::string file =
        weights_folder(settings.weights) + "/skinning/" + scene.garment().name() + ".safetensors";
    if (!std::filesystem::exists(file))
        throw UsageError("solver " + name + ": garment " + scene.garment().name() +
                         " has no skinning network of its own; train one with train_skinning and "
                         "save it as " +
                         file);
    SkinningStepperSettings skinning;
    skinning.project = name == "skinning";
    skinning.proximity.threads = settings.threads;
    auto stepper = std::make_unique<SkinningStepper>(
        scene.garment(), std::make_shared<const SkinningWeights>(SkinningWeights::load(file)),
        std::make_shared<const Body>(Body::load_default()), skinning);
    if (!scene.has_limbs()) return stepper;
    return std::make_unique<WithLimbs>(std::move(stepper));
}

std::shared_ptr<Predictor> make_predictor(const NetworkName& network, const Weights& weights,
                                          const SolverSettings& settings) {
    if (network.torch) return settings.torch(weights);
    const Precision precision = network.bfloat16 ? Precision::bfloat16 : Precision::float32;
    return std::make_shared<Engine>(std::make_shared<const EngineWeights>(weights, precision),
                                    EngineSettings{settings.threads});
}

/// Of a network for steps of this length (s).
long steps_in_frame(const std::string& name, double dt, const ComparisonScene& scene) {
    const long steps = std::clamp(std::lround(scene.frame_time() / dt), 1L, 64L);
    // Without its network it would be another solver under this name.
    if (std::abs(static_cast<double>(steps) * dt - scene.frame_time()) > 1e-6)
        throw UsageError("solver " + name + ": its network takes steps of 1/" +
                         std::to_string(std::lround(1.0 / dt)) +
                         " s; leave it out, or take that --rate");
    return steps;
}

std::unique_ptr<Stepper> make_network(std::string name, const ComparisonScene& scene,
                                      const SolverSettings& settings) {
    ClothStepperSettings learned;
    bool small_steps = false;
    const Integrator integrator = take_integrator(name);
    const NetworkName network(name);
    if (!network.as_shipped) {  // NAME+K: exactly that in every frame
        const std::string prefix = network.variant + "+", whole = prefix + network.refine;
        if (const auto small = small_steps_named(whole, prefix)) {
            learned.step = *small;
            small_steps = true;
        } else {
            learned.step =
                StepSettings::whole(IterationLimits::exactly(iterations_of(whole, prefix, 0, 100)));
            learned.guard.max_substeps = 1;
        }
    }
    set_scene(integrator, scene, learned);
    const Weights weights = Weights::load(weights_file(network.variant, settings.weights));
    if (network.torch && !settings.torch)
        throw UsageError("solver " + name + ": this program is built without LibTorch");
    if (small_steps) steps_in_frame(name, weights.config.dt, scene);  // fixed_dt() may be 0
    return make_cloth(scene.garment(), make_predictor(network, weights, settings), learned,
                      small_steps);
}

/// Of SOLVER~PROXY+DETAIL: K, NETWORK or NETWORK+K.
ProxyDetail detail_named(const std::string& name, const std::string& detail,
                         const SolverSettings& settings) {
    ProxyDetail result;
    if (detail.find_first_not_of("0123456789") == std::string::npos) {
        result.iterations = whole_number("solver " + name, detail, 0, 1000);
        return result;
    }
    const NetworkName network(detail);
    if (network.torch && !settings.torch)
        throw UsageError("solver " + name + ": this program is built without LibTorch");
    if (!network.as_shipped)
        result.iterations = whole_number("solver " + name, network.refine, 0, 1000);
    result.network = make_predictor(
        network, Weights::load(weights_file(network.variant, settings.weights)), settings);
    return result;
}

/// @param tilde  its place in the name
std::unique_ptr<Stepper> make_proxied(const std::string& name, size_t tilde,
                                      const ComparisonScene& scene,
                                      const SolverSettings& settings) {
    const std::string proxy = name.substr(tilde + 1), solver = name.substr(0, tilde);
    const size_t plus = proxy.find('+');
    ProxyDetail detail;
    if (plus != std::string::npos) detail = detail_named(name, proxy.substr(plus + 1), settings);
    return make_proxy_solver(
        name, proxy.substr(0, plus), detail, scene,
        [&](const ComparisonScene& coarse) { return make_solver(solver, coarse, settings); });
}

std::unique_ptr<Stepper> make_own_solver(const std::string& name, const ComparisonScene& scene,
                                         const SolverSettings& settings) {
    if (name == "reference" || name == "reference" + bdf2 || starts_with(name, "newton"))
        return make_newton(name, scene);
    if (name == "default" || starts_with(name, "quasi-newton"))
        return make_quasi_newton(name, scene);
    if (starts_with(name, "xpbd")) return make_xpbd(name, scene);
    if (starts_with(name, "skinning")) return make_skinning(name, scene, settings);
    return make_network(name, scene, settings);
}

}  // namespace

NetworkName::NetworkName(const std::string& name)
    : torch(starts_with(name, "torch-")), bfloat16(starts_with(name, "bf16-")) {
    const std::string network = torch || bfloat16 ? name.substr(name.find('-') + 1) : name;
    const size_t plus = network.find('+');
    variant = network.substr(0, plus);
    as_shipped = plus == std::string::npos;
    if (!as_shipped) refine = network.substr(plus + 1);
}

std::vector<std::string> networks_in(const std::string& folder) {
    std::vector<std::string> names;
    std::error_code unreadable;
    for (const auto& entry :
         std::filesystem::directory_iterator(weights_folder(folder), unreadable))
        if (entry.path().extension() == ".safetensors" && !has_mark(entry.path().stem()))
            names.push_back(entry.path().stem());
    const auto of_detail = [](const std::string& name) {
        const std::string suffix = "_detail";
        return name.size() > suffix.size() &&
               name.compare(name.size() - suffix.size(), suffix.size(), suffix) == 0;
    };
    names.erase(std::remove_if(names.begin(), names.end(), of_detail), names.end());
    std::sort(names.begin(), names.end());
    return names;
}

std::string weights_file(const std::string& variant, const std::string& folder) {
    const std::string file = weights_folder(folder) + "/" + variant + ".safetensors";
    if (std::filesystem::exists(file)) return file;
    throw UsageError(
        "solver " + variant +
        ": is unknown; choose default, bullet, bullet-fine, bullet-K, bullet-KxS, reference, "
        "newton-K, "
        "quasi-newton, quasi-newton-K, quasi-newton-KsR[-cgN], quasi-newton-KxS, xpbd-N, skinning, "
        "skinning-raw or a network of " +
        weights_folder(folder) + " (" + join_list(networks_in(folder), ", ") +
        "), NAME or NAME+K; SOLVER~N and SOLVER~GARMENT simulate a coarser garment by SOLVER, "
        "+K, +NAME or +NAME+K behind that refine what it shows");
}

std::optional<StepSettings> small_steps_named(const std::string& solver,
                                              const std::string& prefix) {
    const size_t mark = solver.find('s', prefix.size());
    if (!starts_with(solver, prefix) || mark == std::string::npos) return std::nullopt;
    const size_t end = solver.find("-cg", mark);
    const std::string first = solver.substr(0, mark), steps = solver.substr(0, end);
    const int rate = iterations_of(steps, first + "s", 1, 9999);
    StepSettings settings =
        StepSettings::in_small_steps(rate, iterations_of(first, prefix, 0, 1000));
    if (end != std::string::npos)
        settings.quasi_newton.hessian_cg_iterations = iterations_of(solver, steps + "-cg", 1, 200);
    return settings;
}

std::unique_ptr<Stepper> make_solver(const std::string& name, const ComparisonScene& scene,
                                     const SolverSettings& settings) {
    if (!settings.weights.empty() && !std::filesystem::is_directory(settings.weights))
        throw UsageError("--weights " + settings.weights +
                         ": there is no such folder; give one with NAME.safetensors");
    refuse_file_of(name, settings.weights);
    const size_t limit = name.rfind('@');
    if (limit != std::string::npos) {
        const int ms = whole_number("solver " + name, name.substr(limit + 1), 1, 100000);
        auto stepper = make_solver(name.substr(0, limit), scene, settings);
        if (!stepper->set_max_ms(ms))
            throw UsageError("solver " + name + ": knows no limit of its time");
        stepper->prepare(scene.frame_time());  // or steps in fewer parts would factorise first
        return stepper;
    }
    const size_t tilde = name.find('~');
    if (tilde != std::string::npos) return make_proxied(name, tilde, scene, settings);
    if (starts_with(name, "bullet"))
        return std::make_unique<BulletClothStepper>(scene.garment(), bullet_settings(name, scene),
                                                    scene.segments());
    auto stepper = make_own_solver(name, scene, settings);
    if (stepper->fixed_dt() == 0.0) return stepper;
    const long parts = steps_in_frame(name, stepper->fixed_dt(), scene);
    if (parts == 1) return stepper;
    return std::make_unique<DividedStepper>(scene.garment(), std::move(stepper),
                                            static_cast<int>(parts));
}

}  // namespace cloth
