#include "demos/speed_error/solver_family.h"

namespace cloth {
namespace {

using Kind = SolverFamily::Kind;

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

/// "K" or "KxS"; Bullet as shipped has two sub-steps per frame.
SolverFamily bullet_family(const std::string& setting) {
    const size_t cross = setting.find('x');
    const int substeps = cross == std::string::npos ? 2 : std::stoi(setting.substr(cross + 1));
    return {Kind::bullet, "Bullet, 1/" + std::to_string(30 * substeps) + " s",
            setting.substr(0, cross), "iterations"};
}

SolverFamily network_family(const std::string& name) {
    const NetworkName network(name);
    const char* backend = network.torch ? ", LibTorch" : network.bfloat16 ? ", bfloat16" : "";
    return {Kind::network, network.variant + backend,
            network.as_shipped ? "shipped" : "+" + network.refine, "iterations"};
}

}  // namespace

SolverFamily solver_family(std::string solver) {
    if (take_bdf2(solver)) {
        SolverFamily family = solver_family(solver);
        family.name += ", BDF2";
        return family;
    }
    if (solver == "bullet") return bullet_family("10x2");
    if (solver == "bullet-fine") return bullet_family("5x8");
    if (const auto setting = after(solver, "bullet-")) return bullet_family(*setting);
    if (const auto setting = after(solver, "xpbd-"))
        return {Kind::xpbd, "XPBD", *setting, "sub-steps"};
    if (solver == "quasi-newton")
        return {Kind::quasi_newton, "quasi-Newton", "shipped", "iterations"};
    if (const auto setting = after(solver, "quasi-newton-"))
        return {Kind::quasi_newton, "quasi-Newton", *setting, "iterations"};
    if (const auto setting = after(solver, "newton-"))
        return {Kind::newton, "Newton", *setting, "iterations"};
    if (solver == "reference") return {Kind::newton, "Newton", "reference", "iterations"};
    return network_family(solver);
}

std::optional<NetworkFacts> network_facts(std::string solver, const SolverSettings& settings) {
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
