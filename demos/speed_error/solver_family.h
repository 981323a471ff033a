#pragma once

#include <optional>
#include <string>

#include "demos/compare/solver_factory.h"

namespace cloth {

/// A solver as one setting of a family.
struct SolverFamily {
    enum class Kind { bullet, xpbd, quasi_newton, newton, network, skinning };
    Kind kind;
    std::string name;     ///< for a legend: "quasi-Newton", "Bullet, 8 sub-steps", "fast, LibTorch"
    std::string setting;  ///< for a point: "3", "+10", "shipped"
    std::string counts;   ///< what the setting is a number of: "iterations"
};

/// What a name that make_solver() knows says.
SolverFamily solver_family(std::string solver);

/// What a network is run by and is.
struct NetworkFacts {
    std::string backend;        ///< engine, engine-bf16, libtorch
    int width;                  ///< of the latents
    std::optional<int> refine;  ///< quasi-Newton iterations after it; none: as shipped
};

/// Nothing for solvers without a network. @throws UsageError, LoadError as make_solver() does
std::optional<NetworkFacts> network_facts(std::string solver, const SolverSettings& settings);

}  // namespace cloth
