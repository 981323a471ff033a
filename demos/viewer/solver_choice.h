#pragma once

#include <string>
#include <vector>

namespace cloth {

/// A solver's name as a kind and a number: "xpbd-40" is 40 of "xpbd-N", "small+3" 3 of "small+K".
struct SolverChoice {
    std::string kind;  ///< of solver_kinds(), or a whole name that make_solver() takes
    int k = 10;        ///< iterations or sub-steps, 1 to 200; nothing for a kind without a number

    bool has_number() const;
    std::string name() const;  ///< as make_solver() takes it

    /// The choice that has this name.
    static SolverChoice of(const std::string& name);
};

/// What can be chosen from: physics, XPBD, and each network as shipped and with K iterations.
std::vector<std::string> solver_kinds();

}  // namespace cloth
