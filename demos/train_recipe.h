#pragma once

#include <map>
#include <string>
#include <vector>

#include "gnn/train/recipe.h"

namespace cloth {

/// An option of `train` that replaces a number of the recipe.
struct RecipeOption {
    const char *name, *type, *description;
    void (*set)(Recipe&, double);
    int low = 0, high = 0;  ///< of whole numbers; both 0: it is none, Recipe::check() has its range
};

const std::vector<RecipeOption>& recipe_options();

/// @param given  values by the names of the options
/// @throws ArgumentError for a value that is not whole or out of range, or an option that has no
///         effect on what the recipe does
void set_recipe(const std::map<std::string, double>& given, Recipe& recipe);

}  // namespace cloth
