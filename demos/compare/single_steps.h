#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "demos/compare/step_energies.h"

namespace cloth {

/// Figures of a solver's single steps from the reference's states, one entry per frame. A step that
/// gave no finite numbers is NaN.
struct SingleSteps {
    std::vector<double> gap, progress, rmse;  ///< rmse in mm
    std::vector<EnergyTerms> terms;           ///< of the finite steps

    /// Scores the result x of the step that `energies` has begun.
    /// @param converged  the reference's result
    void score(const StepEnergies& energies, const Points& x, const Points& converged);
};

/// The terms that cloth on a body has, by name; null for what is not finite.
nlohmann::json to_json(const EnergyTerms& terms);
/// Of each term.
EnergyTerms mean_terms(const std::vector<EnergyTerms>& all);

/// The entry `one_step` of a report; null without any step.
nlohmann::json to_json(const SingleSteps& steps);

}  // namespace cloth
