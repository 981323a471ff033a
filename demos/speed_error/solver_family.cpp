#include "demos/speed_error/solver_family.h"

namespace cloth {
namespace {

using Kind = SolverFamily::Kind;

constexpr size_t npos = std::string::npos;

/// What follows `prefix` in `name`; nothing if it does not begin so.
std::optional<std::string> after(const std::string& name, const std::string& prefix) {
    if (name.rfind(prefix, 0) != 0) return std::nullopt;
    return name.substr(prefix.size());
}

/// Takes "-bdf2" off the end; false: it is not there.
bool take_bdf2(std::string& name) {
    const std::string end = "-bdf2";
    if (name.size() <= end.size() || name.substr(name.size() - end.size()) != end) return false;
    name.resize(name.size() - end.size());
    return true;
}

/// Takes "@M" off the end; empty: it is not there.
std::string take_limit(std::string& name) {
    const size_t at = name.rfind('@');
    if (at == std::string::npos) return "";
    const std::string limit = name.substr(at + 1);
    name.resize(at);
    return limit;
}

/// Takes "~PROXY" off the end; empty: it is not there.
std::string take_proxy(std::string& name) {
    const size_t at = name.find('~');
    if (at == std::string::npos) return "";
    const std::string proxy = name.substr(at + 1);
    name.resize(at);
    return proxy;
}

/// "K", in steps as shipped, or "KxS".
SolverFamily bullet_family(const std::string& setting) {
    const size_t cross = setting.find('x');
    const std::string steps =
        cross == std::string::npos ? "1/60 s" : setting.substr(cross + 1) + " sub-steps";
    return {Kind::bullet, "Bullet, " + steps, setting.substr(0, cross), "iterations"};
}

SolverFamily network_family(const std::string& name) {
    const NetworkName network(name);
    const char* backend = network.torch ? ", LibTorch" : network.bfloat16 ? ", bfloat16" : "";
    return {Kind::network, network.variant + backend,
            network.as_shipped ? "shipped" : "+" + network.refine, "iterations"};
}

}  // namespace

SolverFamily solver_family(std::string solver) {
    if (const std::string limit = take_limit(solver); !limit.empty()) {
        SolverFamily family = solver_family(solver);
        family.name += ", limit of time";
        family.setting += "@" + limit;
        return family;
    }
    if (const std::string proxy = take_proxy(solver); !proxy.empty()) {
        SolverFamily family = solver_family(solver);
        family.name += ", proxy " + proxy;
        return family;
    }
    if (take_bdf2(solver)) {
        SolverFamily family = solver_family(solver);
        family.name += ", BDF2";
        return family;
    }
    if (solver == "bullet") return bullet_family("10");
    if (solver == "bullet-fine") return {Kind::bullet, "Bullet, 1/240 s", "5", "iterations"};
    if (const auto setting = after(solver, "bullet-")) return bullet_family(*setting);
    if (const auto setting = after(solver, "xpbd-"))
        return {Kind::xpbd, "XPBD", *setting, "sub-steps"};
    if (solver == "default")
        return {Kind::quasi_newton, "quasi-Newton, small steps", "shipped", "iterations, steps"};
    if (solver == "quasi-newton")
        return {Kind::quasi_newton, "quasi-Newton", "shipped", "iterations"};
    if (const auto setting = after(solver, "quasi-newton-"); setting && setting->find('s') < npos)
        return {Kind::quasi_newton, "quasi-Newton, small steps", *setting, "iterations, steps"};
    if (const auto setting = after(solver, "quasi-newton-"))
        return {Kind::quasi_newton, "quasi-Newton", *setting, "iterations"};
    if (const auto setting = after(solver, "newton-"))
        return {Kind::newton, "Newton", *setting, "iterations"};
    if (solver == "reference") return {Kind::newton, "Newton", "reference", "iterations"};
    if (solver == "skinning")
        return {Kind::skinning, "skinning network", "projected", "projection"};
    if (solver == "skinning-raw") return {Kind::skinning, "skinning network", "raw", "projection"};
    return network_family(solver);
}

std::optional<NetworkFacts> network_facts(std::string solver, const SolverSettings& settings) {
    take_limit(solver);
    take_proxy(solver);
    take_bdf2(solver);
    const SolverFamily family = solver_family(solver);
    if (family.kind != Kind::network) return std::nullopt;
    const NetworkName network(solver);
    const std::string file = weights_file(network.variant, settings.weights);
    std::optional<int> refine;
    if (!network.as_shipped) refine = std::stoi(network.refine);
    const char* backend = network.torch ? "libtorch" : network.bfloat16 ? "engine-bf16" : "engine";
    return NetworkFacts{backend, Weights::load(file).config.width, refine};
}

}  // namespace cloth
