#pragma once

#include <memory>
#include <vector>

#include "gnn/train/network.h"
#include "gnn/train/training_worlds.h"

namespace cloth {

struct ValidationSettings {
    int garment_states = 8;       ///< of a garment on a clip that is never trained on, 0 to 1000
    int sheet_states = 8;         ///< 0 to 1000
    int rollout_iterations = 12;  ///< of the solver that makes the states, 1 to 1000
    int minimum_iterations = 80;  ///< of the solver that finds the least energy, 1 to 10,000
    size_t garment = 99;          ///< index into the factory's garments, the last if out of range

    /// @throws ArgumentError if a value is out of its range
    void check() const;
};

/// Energy gaps (E(x) - Emin) / (E(base) - Emin) of one step, and RMS distances to the positions of
/// least energy, over fixed states.
struct GapSummary {
    double median = 0.0, p95 = 0.0;
    double error_mm = 0.0;  ///< median distance
};

struct ValidationResult {
    GapSummary tshirt, sheet;  ///< NaN without states
};

/// Single steps from fixed states that are never trained on, with the least energy of each.
class Validation {
 public:
    Validation(const SceneFactory& factory, ValidationSettings settings);

    ValidationResult measure(Network& network);
    /// The same for the solver alone, for comparison.
    ValidationResult measure_solver(int iterations);

    /// Of the states, since the starts of their scenes (s).
    std::vector<double> times() const;

 private:
    struct State {
        std::shared_ptr<TrainingScene> scene;
        ClothState state;
        double least = 0.0, base = 0.0;
        Points minimum;  ///< |V| x 3 (m)
    };
    void add_states(std::shared_ptr<TrainingScene> scene, double first, double every, int count);
    template <typename Predict>
    ValidationResult measure_with(Predict predict);

    ValidationSettings m_settings;
    std::vector<State> m_states;
};

/// Predicted positions (|V| x 3, m) of a prepared scene; pinned vertices stay at their targets.
Points to_positions(const TrainingScene& scene, const torch::Tensor& output);

}  // namespace cloth
