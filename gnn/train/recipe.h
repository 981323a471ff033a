#pragma once

#include <cstdint>
#include <string>

#include "gnn/train/loss.h"

namespace cloth {

/// How training changes over time. `progress` runs from 0 to 1 over the whole training.
///
/// `paper`: FastClothGNN's and HOOD's: Adam at 1e-4 halved every 30,000 iterations, rollouts of 1
/// to 5 steps (one more every 3000 iterations, detached, an update per step), position noise of
/// 3 mm, gradient norm at most 1, contact weight from 5e3 to 5e5.
///
/// `quick`: learns in an hour on a processor core: high rate with warm-up and cosine decay, the log
/// of the energy gap as loss, single steps on states that a few solver iterations heal, with ever
/// more states that the network reached by itself.
struct Recipe {
    std::string name = "quick";
    LossKind loss = LossKind::both;
    double base_rate = 2e-3;  ///< highest learning rate, 1e-8 to 1
    bool cosine = true;       ///< cosine decay to 2 % after a warm-up; else halving
    double noise = 0.0;       ///< of x_t and x_{t-1} (m), 0 to 0.1
    double clip_norm = 0.0;   ///< 0 to 1e6; 0: twice the running median of the norms
    int max_rollout = 1;      ///< steps, 1 to 100
    double heal_first = 0.8, heal_last = 0.35;  ///< share of solver-made next states, 0 to 1
    int heal_iterations =
        6;  ///< quasi-Newton iterations of a healed state and of the target, 0 to 1000
    double contact_first = 5e5,
           contact_last = 5e5;  ///< ramp of the contact weight (N/m^2), 1e3 to 1e6

    /// @throws ArgumentError unless `name` is paper or quick
    /// @param width  of the network: wide ones take a lower rate
    static Recipe named(const std::string& name, int width);

    /// @throws ArgumentError naming the field that is out of range
    void check() const;

    double learning_rate(std::int64_t iteration, double progress) const;
    int rollout(std::int64_t iteration) const;
    double heal_share(double progress) const;
    double contact_weight(double progress) const;
};

}  // namespace cloth
