#include "demos/compare/single_steps.h"

#include <limits>

#include "demos/compare/json_numbers.h"
#include "demos/compare/statistics.h"
#include "demos/compare/trajectory.h"

namespace cloth {

using nlohmann::json;

json to_json(const EnergyTerms& terms) {
    return {{"strain", json_number(terms.strain)},   {"bending", json_number(terms.bending)},
            {"gravity", json_number(terms.gravity)}, {"inertia", json_number(terms.inertia)},
            {"contact", json_number(terms.contact)}, {"friction", json_number(terms.friction)}};
}

EnergyTerms mean_terms(const std::vector<EnergyTerms>& all) {
    EnergyTerms mean;
    const double weight = 1.0 / static_cast<double>(all.size());
    for (const EnergyTerms& terms : all) {
        mean.strain += weight * terms.strain;
        mean.bending += weight * terms.bending;
        mean.gravity += weight * terms.gravity;
        mean.inertia += weight * terms.inertia;
        mean.contact += weight * terms.contact;
        mean.friction += weight * terms.friction;
    }
    return mean;
}

void SingleSteps::score(const StepEnergies& energies, const Points& x, const Points& converged) {
    if (!x.allFinite()) {
        for (std::vector<double>* values : {&gap, &progress, &rmse})
            values->push_back(std::numeric_limits<double>::quiet_NaN());
        return;
    }
    const double minimum = energies.potential().value(converged);
    const double energy = energies.potential().value(x);
    gap.push_back(energies.gap(energy, minimum));
    progress.push_back(energies.progress(energy, minimum));
    rmse.push_back(rmse_mm(x, converged));
    terms.push_back(energies.potential().terms(x));
}

json to_json(const SingleSteps& steps) {
    if (steps.gap.empty()) return nullptr;
    return {{"frames", steps.gap.size()},
            {"gap",
             {{"median", json_number(median(steps.gap))},
              {"p95", json_number(quantile(steps.gap, 0.95))}}},
            {"progress", {{"median", json_number(median(steps.progress))}}},
            {"rmse_mm", json_number(mean_of_known(steps.rmse))},
            {"energy_terms", to_json(mean_terms(steps.terms))},
            {"gap_per_frame", json_numbers(steps.gap)}};
}

}  // namespace cloth
