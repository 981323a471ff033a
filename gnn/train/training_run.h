#pragma once

#include <chrono>

#include "gnn/train/metrics_file.h"
#include "gnn/train/time_budget.h"
#include "gnn/train/trainer.h"

namespace cloth {

/// A training from its start, or from where it is resumed, to its end.
struct Trainer::Run {
    using Clock = std::chrono::steady_clock;

    /// @param trained  (s) so far
    Run(const TrainerSettings& settings, const std::atomic<bool>& stop, double trained,
        std::int64_t iteration);

    /// Trained so far (s).
    double seconds() const {
        return seconds_before + std::chrono::duration<double>(Clock::now() - start).count();
    }

    const std::atomic<bool>& stop;
    MetricsFile metrics, rollouts;
    TimeBudget budget;
    Clock::time_point start = Clock::now();
    double seconds_before;
    std::int64_t first_iteration;
};

/// While it lives, the network has the mean of its parameters, if the recipe keeps one.
class Trainer::WithMean {
 public:
    explicit WithMean(Trainer& trainer) : m_trainer(trainer) { swap(); }
    ~WithMean() { swap(); }
    WithMean(const WithMean&) = delete;
    WithMean& operator=(const WithMean&) = delete;

 private:
    void swap();

    Trainer& m_trainer;
};

}  // namespace cloth
