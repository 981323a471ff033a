#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "gnn/train/trainer.h"

namespace cloth::test {

/// A small network on sheets, trained in a second.
/// @param name  of its folder, which is emptied
inline TrainerSettings tiny_training(const std::string& name, const std::string& recipe) {
    TrainerSettings settings;
    settings.model = ModelConfig::variant_named("fast");
    settings.model.width = 16;
    settings.model.steps = 4;
    settings.recipe = Recipe::named(recipe, 16);
    settings.scenes.garment_share = 0.0;
    settings.scenes.sheet_sizes = {60};
    settings.validation.garment_states = 0;
    settings.validation.sheet_states = 4;
    settings.rollouts.sheet_vertices = 60;
    settings.rollouts.frames = 4;
    settings.iterations = 40;
    settings.pool = 4;
    settings.freeze_statistics = 15;
    settings.out = testing::TempDir() + name;
    std::filesystem::remove_all(settings.out);
    return settings;
}

}  // namespace cloth::test
