#include "gnn/train/recipe.h"

#include <algorithm>
#include <cmath>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

Recipe Recipe::named(const std::string& name, int width) {
    Recipe recipe;
    recipe.name = name;
    recipe.base_rate = width >= 128 ? 1e-3 : width >= 64 ? 1.5e-3 : 2e-3;
    if (name == "quick") return recipe;
    if (name != "paper")
        throw ArgumentError("recipe '" + name + "'", "is not known", "use paper or quick");
    recipe.loss = LossKind::energy;
    recipe.base_rate = 1e-4;
    recipe.cosine = false;
    recipe.noise = 3e-3;
    recipe.clip_norm = 1.0;
    recipe.max_rollout = 5;
    recipe.heal_first = recipe.heal_last = 1.0;
    recipe.contact_first = 5e3;
    return recipe;
}

void Recipe::check() const {
    check_range("Recipe.base_rate", base_rate, 1e-8, 1.0);
    check_range("Recipe.noise", noise, 0.0, 0.1);
    check_range("Recipe.clip_norm", clip_norm, 0.0, 1e6);
    check_range("Recipe.max_rollout", max_rollout, 1, 100);
    check_range("Recipe.heal_first", heal_first, 0.0, 1.0);
    check_range("Recipe.heal_last", heal_last, 0.0, 1.0);
    check_range("Recipe.heal_iterations", heal_iterations, 0, 1000);
    check_range("Recipe.contact_first", contact_first, 1e3, 1e6);
    check_range("Recipe.contact_last", contact_last, 1e3, 1e6);
}

double Recipe::learning_rate(std::int64_t iteration, double progress) const {
    if (!cosine) return base_rate * std::pow(0.5, static_cast<double>(iteration / 30000));
    const double warm_up = std::min(1.0, static_cast<double>(iteration + 1) / 100.0);
    const double decay =
        0.02 + 0.98 * 0.5 * (1.0 + std::cos(M_PI * std::clamp(progress, 0.0, 1.0)));
    return base_rate * warm_up * decay;
}

int Recipe::rollout(std::int64_t iteration) const {
    return static_cast<int>(std::min<std::int64_t>(1 + iteration / 3000, max_rollout));
}

double Recipe::heal_share(double progress) const {
    return heal_first + (heal_last - heal_first) * std::clamp(progress, 0.0, 1.0);
}

double Recipe::contact_weight(double progress) const {
    // The ramp ends at two thirds of the training: the final weight needs time to be learned.
    const double part = std::clamp(1.5 * progress, 0.0, 1.0);
    return contact_first + (contact_last - contact_first) * part;
}

}  // namespace cloth
