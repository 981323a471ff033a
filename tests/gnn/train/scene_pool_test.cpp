#include "gnn/train/scene_pool.h"

#include <gtest/gtest.h>

namespace cloth::scene_pool_test {
namespace {

const Recipe recipe = Recipe::named("kicks", 16);

SceneFactory sheets() {
    SceneSettings settings;
    settings.garment_share = 0.0;
    settings.sheet_sizes = {60};
    return SceneFactory(ModelConfig::variant_named("fast", 3), settings, 1);
}

/// The states that the next scenes start from.
std::vector<Points> replaced(ScenePool& pool, int count) {
    std::vector<Points> states;
    for (int k = 0; k < count; ++k) {
        pool.draw();
        pool.replace_drawn(recipe, 0.5);
        states.push_back(pool.drawn().state.x);
    }
    return states;
}

ScenePool filled(const SceneFactory& factory, bool in_background) {
    ScenePool pool(factory, 3, 7, in_background);
    int made = 0;
    pool.fill(recipe, std::atomic<bool>{false}, [&] { ++made; });
    EXPECT_EQ(made, 3);
    return pool;
}

TEST(ScenePool, ScenesMadeInTheBackgroundAreTheSame) {
    const SceneFactory factory = sheets();
    ScenePool ahead = filled(factory, true), when_needed = filled(factory, false);
    const std::vector<Points> states = replaced(ahead, 5);
    EXPECT_EQ(states, replaced(when_needed, 5));
    EXPECT_NE(states[0], states[1]);
}

TEST(ScenePool, GoesOnFromItsStateWithTheSpareScene) {
    const SceneFactory factory = sheets();
    ScenePool pool = filled(factory, true);
    replaced(pool, 2);
    ScenePool again(factory, 3, 99, false);
    again.set_state(recipe, pool.state());
    EXPECT_EQ(replaced(pool, 4), replaced(again, 4));
}

TEST(ScenePool, IsEmptyIfItIsStoppedWhileItIsFilled) {
    const SceneFactory factory = sheets();
    ScenePool pool(factory, 3, 7, true);
    pool.fill(recipe, std::atomic<bool>{true}, [] { ADD_FAILURE(); });
    EXPECT_TRUE(pool.empty());
}

}  // namespace
}  // namespace cloth::scene_pool_test
