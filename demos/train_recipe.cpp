#include "demos/train_recipe.h"

#include <cmath>
#include <initializer_list>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

const std::vector<RecipeOption>& recipe_options() {
    static const std::vector<RecipeOption> options = {
        {"--learning-rate", "R", "", [](Recipe& r, double v) { r.base_rate = v; }},
        {"--mean-share", "P",
         "share of the iterations so far over which parameters are averaged for saving; 0: the "
         "last",
         [](Recipe& r, double v) { r.mean_share = v; }},
        {"--position-weight", "W", "of the error of position in the loss",
         [](Recipe& r, double v) { r.position_weight = v; }},
        {"--target-iterations", "K",
         "quasi-Newton iterations to the target of the loss, a healed state too",
         [](Recipe& r, double v) { r.target_iterations = static_cast<int>(v); }, 1, 1000},
        {"--loss-iterations", "K",
         "quasi-Newton iterations between the network's answer and the loss",
         [](Recipe& r, double v) { r.loss_iterations = static_cast<int>(v); }, 0, 100},
        {"--heal", "K", "quasi-Newton iterations of warm-up frames",
         [](Recipe& r, double v) { r.heal_iterations = static_cast<int>(v); }, 1, 1000},
        {"--healed-first", "P", "share of next states that are the solver's, at the start",
         [](Recipe& r, double v) { r.heal_first = v; }},
        {"--healed-last", "P", "the same at the end", [](Recipe& r, double v) { r.heal_last = v; }},
        {"--own-refined", "P", "share of the network's own next states that iterations refine",
         [](Recipe& r, double v) { r.own_refined = v; }},
        {"--own-iterations", "K", "these iterations",
         [](Recipe& r, double v) { r.own_iterations = static_cast<int>(v); }, 0, 100},
        {"--kicks", "P", "share of the iterations that perturb their scene",
         [](Recipe& r, double v) { r.kicks.share = v; }},
        {"--skinned", "P",
         "share of garment scenes that start posed with the body in the midst of a motion",
         [](Recipe& r, double v) { r.skinned.share = v; }},
        {"--skinned-at-rest", "P", "share of these that start without velocity",
         [](Recipe& r, double v) { r.skinned.at_rest = v; }},
        {"--skinned-noise", "M", "noise of their positions (m)",
         [](Recipe& r, double v) { r.skinned.noise = v; }},
        {"--noise", "M", "noise of positions, for single steps (m)",
         [](Recipe& r, double v) { r.noise = v; }},
        {"--rollout", "N",
         "steps of the network from its own states in an iteration at most: one in the first 3,000 "
         "iterations, one more after each 3,000",
         [](Recipe& r, double v) { r.max_rollout = static_cast<int>(v); }, 1, 100},
    };
    return options;
}

static void set(const RecipeOption& option, double value, Recipe& recipe) {
    if (option.low < option.high) {
        if (std::isfinite(value) && value != std::floor(value))
            throw ArgumentError(option.name, "takes whole numbers only",
                                "give " + std::to_string(std::lround(value)));
        check_range(option.name, value, option.low, option.high);
    }
    option.set(recipe, value);
}

/// An option that changes nothing is a mistake, which must not be found days later.
static void check_effects(const std::map<std::string, double>& given, const Recipe& recipe) {
    const auto refuse = [&](std::initializer_list<const char*> names, const char* problem,
                            const char* remedy) {
        for (const char* name : names)
            if (given.count(name) > 0) throw ArgumentError(name, problem, remedy);
    };
    if (recipe.noise > 0.0)
        refuse({"--healed-first", "--healed-last", "--own-refined", "--own-iterations"},
               "has no effect with noise, which scenes go on without, as the solver moves them",
               "leave it out, or give --noise 0");
    if (recipe.heal_first == 1.0 && recipe.heal_last == 1.0)
        refuse({"--own-refined", "--own-iterations"},
               "has no effect where all next states are the solver's",
               "leave it out, or give a lower --healed-first or --healed-last");
    if (recipe.own_refined == 0.0)
        refuse({"--own-iterations"}, "has no effect where no own state is refined",
               "leave it out, or give --own-refined");
    if (recipe.skinned.share == 0.0)
        refuse({"--skinned-at-rest", "--skinned-noise"},
               "has no effect where no scene starts posed with the body",
               "leave it out, or give --skinned");
}

void set_recipe(const std::map<std::string, double>& given, Recipe& recipe) {
    for (const RecipeOption& option : recipe_options()) {
        const auto found = given.find(option.name);
        if (found != given.end()) set(option, found->second, recipe);
    }
    check_effects(given, recipe);
}

}  // namespace cloth
