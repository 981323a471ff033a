#pragma once

#include <cstdint>
#include <vector>

#include "gnn/physics/energy/incremental_potential.h"

namespace cloth {

/// What a row of metrics.csv averages.
struct TrainingSums {
    EnergyTerms terms;
    double loss = 0.0;
    std::vector<double> gaps, errors;
    double prepare_seconds = 0.0, network_seconds = 0.0, solver_seconds = 0.0;  ///< of processor
    int count = 0, terms_count = 0, resets = 0, kicks = 0;
    std::int64_t first_iteration = 0;
    double first_second = 0.0;

    void add(const EnergyTerms& more) {
        terms.strain += more.strain;
        terms.bending += more.bending;
        terms.gravity += more.gravity;
        terms.inertia += more.inertia;
        terms.contact += more.contact;
        terms.friction += more.friction;
        ++terms_count;
    }
};

}  // namespace cloth
