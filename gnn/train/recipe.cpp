#include "gnn/train/recipe.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

Recipe quick_recipe(int width) {
    Recipe recipe;
    recipe.base_rate = width >= 128 ? 1e-3 : width >= 64 ? 1.5e-3 : 2e-3;
    return recipe;
}

Recipe kicks_recipe(int width) {
    Recipe recipe = quick_recipe(width);
    recipe.position_weight = 1.0;
    recipe.kicks.share = 0.2;
    return recipe;
}

Recipe own_recipe(int width) {
    Recipe recipe = kicks_recipe(width);
    recipe.base_rate *= 0.5;
    recipe.heal_first = 0.3;
    recipe.heal_last = 0.0;
    recipe.kicks.share = 0.1;
    return recipe;
}

Recipe paper_recipe() {
    Recipe recipe;
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

}  // namespace

const std::vector<std::string>& Recipe::names() {
    static const std::vector<std::string> names = {"kicks", "own", "quick", "paper"};
    return names;
}

Recipe Recipe::named(const std::string& name, int width) {
    Recipe recipe;
    if (name == "kicks")
        recipe = kicks_recipe(width);
    else if (name == "own")
        recipe = own_recipe(width);
    else if (name == "quick")
        recipe = quick_recipe(width);
    else if (name == "paper")
        recipe = paper_recipe();
    else
        throw ArgumentError("recipe '" + name + "'", "is not known",
                            "use kicks, own, quick or paper");
    recipe.name = name;
    return recipe;
}

void Recipe::check() const {
    check_range("Recipe.position_weight", position_weight, 0.0, 10.0);
    check_range("Recipe.target_iterations", target_iterations, 1, 1000);
    check_range("Recipe.loss_iterations", loss_iterations, 0, 100);
    check_range("Recipe.base_rate", base_rate, 1e-7, 0.1);
    check_range("Recipe.mean_share", mean_share, 0.0, 1.0);
    check_range("Recipe.clip_norm", clip_norm, 0.0, 1e6);
    check_range("Recipe.heal_first", heal_first, 0.0, 1.0);
    check_range("Recipe.heal_last", heal_last, 0.0, 1.0);
    check_range("Recipe.heal_iterations", heal_iterations, 1, 1000);
    check_range("Recipe.own_refined", own_refined, 0.0, 1.0);
    check_range("Recipe.own_iterations", own_iterations, 0, 100);
    kicks.check();
    skinned.check();
    check_range("Recipe.noise", noise, 0.0, 0.02);
    check_range("Recipe.max_rollout", max_rollout, 1, 100);
    check_range("Recipe.rollout_growth", rollout_growth, 1, 1e9);
    check_range("Recipe.contact_first", contact_first, 1e3, 1e6);
    check_range("Recipe.contact_last", contact_last, 1e3, 1e6);
}

std::string Recipe::describe() const {
    std::ostringstream text;
    text << "recipe " << name << " loss " << static_cast<int>(loss) << " position "
         << position_weight << " target " << target_iterations << " loss after " << loss_iterations
         << " rate " << base_rate << ' ' << cosine << " clip " << clip_norm << " heal "
         << heal_first << ' ' << heal_last << ' ' << heal_iterations << " own " << own_refined
         << ' ' << own_iterations << " kicks " << kicks.share << ' ' << kicks.least_wavelength
         << ' ' << kicks.most_wavelength << ' ' << kicks.slope << ' ' << kicks.offset << ' '
         << kicks.speed << ' ' << kicks.noise_share << ' ' << kicks.noise << " skinned "
         << skinned.share << ' ' << skinned.at_rest << ' ' << skinned.noise << " noise " << noise
         << " rollout " << max_rollout << ' ' << rollout_growth << " contact " << contact_first
         << ' ' << contact_last;
    if (mean_share > 0.0) text << " mean " << mean_share;
    return text.str();
}

double Recipe::learning_rate(std::int64_t iteration, double progress) const {
    if (!cosine) return base_rate * std::pow(0.5, static_cast<double>(iteration / 30000));
    const double warm_up = std::min(1.0, static_cast<double>(iteration + 1) / 100.0);
    const double decay =
        0.02 + 0.98 * 0.5 * (1.0 + std::cos(M_PI * std::clamp(progress, 0.0, 1.0)));
    return base_rate * warm_up * decay;
}

int Recipe::rollout(std::int64_t iteration) const {
    return static_cast<int>(std::min<std::int64_t>(1 + iteration / rollout_growth, max_rollout));
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
