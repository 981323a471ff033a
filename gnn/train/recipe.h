#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gnn/train/kicks.h"
#include "gnn/train/loss.h"
#include "gnn/train/skinned_start.h"

namespace cloth {

/// What a network is trained on, and how that changes over time. `progress` runs from 0 to 1 over
/// the whole training.
///
/// `kicks`: the default, for width 32 and 8 steps: `quick` with the position error in the loss and
/// kicks in a fifth of the iterations; what held a T-shirt longest in measurements.
///
/// `own`: goes on from weights of `kicks`: half the rate, hardly a state that the solver made,
/// kicks in a tenth of the iterations.
///
/// `quick`: learns in an hour on a processor core: high rate with warm-up and cosine decay, the log
/// of the energy gap as loss, single steps on states that a few solver iterations heal, with ever
/// more states that the network reached by itself.
///
/// `paper`: FastClothGNN's and HOOD's: Adam at 1e-4 halved every 30,000 iterations, rollouts of 1
/// to 5 steps (one more every 3000 iterations, detached, an update per step), position noise of
/// 3 mm, gradient norm at most 1, contact weight from 5e3 to 5e5.
struct Recipe {
    std::string name = "quick";

    LossKind loss = LossKind::both;
    /// Of the position error in the loss, 0 to 10.
    double position_weight = 0.0;
    /// Quasi-Newton iterations that find the loss' target, which is a healed state too, 1 to 1000.
    int target_iterations = 6;
    /// Quasi-Newton iterations between the network's answer and the loss, 0 to 100: what is trained
    /// is then what they cannot do. Their Jacobian is left out: the loss' gradient is taken behind
    /// them and passed on to the network as it is.
    int loss_iterations = 0;

    double base_rate = 2e-3;  ///< learning rate, 1e-7 to 0.1
    bool cosine = true;       ///< cosine decay to 2 % after a warm-up; else halving
    /// Share of the iterations so far, 0 to 1, over which the parameters are averaged for saving
    /// and validating; 0: the last ones. The last ones jump about their mean, the more so the
    /// higher the rate (Polyak and Juditsky 1992).
    double mean_share = 0.0;
    double clip_norm = 0.0;  ///< of the gradient, 0 to 1e6; 0: twice the running median

    /// Share of next states that are the solver's, at the beginning and at the end, 0 to 1.
    double heal_first = 0.8, heal_last = 0.35;
    int heal_iterations = 6;   ///< quasi-Newton iterations of warm-up frames, 1 to 1000
    double own_refined = 0.5;  ///< share of the network's own next states that iterations refine
    int own_iterations = 2;    ///< these quasi-Newton iterations, 0 to 100
    KickSettings kicks;
    SkinnedStartSettings skinned;

    /// Position noise of x_t and x_{t-1} (m), 0 to 0.02. Scenes with noise go on as the solver
    /// moves them, from before the noise.
    double noise = 0.0;
    /// Steps of the network from its own states in an iteration, 1 to 100; an update per step,
    /// without gradients through time.
    int max_rollout = 1;
    int rollout_growth = 3000;  ///< iterations for each more of them, 1 to 1e9

    /// Ramp of the contact weight (N/m^2), 1e3 to 1e6.
    double contact_first = 5e5, contact_last = 5e5;

    /// @throws ArgumentError unless `name` is one of names()
    /// @param width  of the network: wide ones take a lower rate
    static Recipe named(const std::string& name, int width);
    static const std::vector<std::string>& names();

    /// @throws ArgumentError if a value is out of its range
    void check() const;
    /// All values, for telling two recipes apart.
    std::string describe() const;

    double learning_rate(std::int64_t iteration, double progress) const;
    int rollout(std::int64_t iteration) const;
    double heal_share(double progress) const;
    double contact_weight(double progress) const;
};

}  // namespace cloth
