#include "demos/train_series/training_series.h"

#include <algorithm>

#include "data/core/errors.h"

namespace cloth {

namespace {

TrainingSeries states() {
    return {
        "states",
        "what a network is trained on",
        {"--width", "16", "--steps", "6", "--validation-frames", "60"},
        6000,
        {
            {"kicks", "the default: perturbed states, the solver's and the network's own", {}},
            {"no kicks", "the same without perturbations", {"--kicks", "0"}},
            {"noise", "the paper's: noise of 3 mm instead", {"--kicks", "0", "--noise", "3e-3"}},
            {"skinned",
             "kicks, and a third of the garments start posed with the body",
             {"--skinned", "0.33"}},
            {"solver's",
             "kicks, next states are the solver's",
             {"--healed-first", "1", "--healed-last", "1"}},
            {"own",
             "kicks, next states are the network's own",
             {"--healed-first", "0", "--healed-last", "0"}},
            {"rollouts",
             "kicks, a second step from own states in iterations after the first 3,000, a third "
             "after 6,000",
             {"--rollout", "3"}},
            {"energy alone",
             "kicks, without the error of position in the loss",
             {"--position-weight", "0"}},
            {"loss after 3",
             "kicks, the loss is taken after 3 iterations of the solver",
             {"--loss-iterations", "3"}},
        }};
}

TrainingSeries variants() {
    return {"variants",
            "the paper's four networks, of 21 steps and width 32",
            {"--width", "32", "--steps", "21"},
            110000,
            {
                {"baseline", "all edges, a message for each", {"--variant", "baseline"}},
                {"sampling", "sampled edges", {"--variant", "sampling"}},
                {"reduction", "reduced messages", {"--variant", "reduction"}},
                {"fast", "both", {"--variant", "fast"}},
            }};
}

/// Figure 7 of the paper, with a small network.
TrainingSeries neighbours() {
    TrainingSeries series = {
        "neighbours",
        "how many neighbours a vertex hears in a message passing step",
        {"--variant", "fast", "--width", "16", "--steps", "6", "--validation-garments",
         "tshirt_1000", "--validation-clips", "01_01"},
        3000,
        {}};
    for (int count = 1; count <= 7; ++count) {
        const std::string number = std::to_string(count);
        series.trainings.push_back({number,
                                    number + (count == 1 ? " neighbour" : " neighbours"),
                                    {"--sampled-edges", number}});
    }
    return series;
}

}  // namespace

const std::vector<TrainingSeries>& training_series() {
    static const std::vector<TrainingSeries> all = {states(), variants(), neighbours()};
    return all;
}

const TrainingSeries& training_series(const std::string& name) {
    const auto& all = training_series();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const TrainingSeries& one) { return one.name == name; });
    if (found != all.end()) return *found;
    std::string names;
    for (const TrainingSeries& one : all) names += (names.empty() ? "" : ", ") + one.name;
    throw ArgumentError("series '" + name + "'", "is not known", "choose one of " + names);
}

}  // namespace cloth
