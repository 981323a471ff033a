#include "gnn/train/trainer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "data/core/errors.h"

namespace cloth {
namespace {

TrainerSettings tiny(const std::string& name, const std::string& recipe = "quick") {
    TrainerSettings settings;
    settings.model = ModelConfig::variant_named("fast");
    settings.model.width = 16;
    settings.model.steps = 4;
    settings.recipe = Recipe::named(recipe, 16);
    settings.scenes.tshirt_share = 0.0;
    settings.scenes.sheet_sizes = {60};
    settings.validation.tshirt_states = 0;
    settings.validation.sheet_states = 4;
    settings.iterations = 40;
    settings.pool = 4;
    settings.freeze_statistics = 15;
    settings.out = testing::TempDir() + "trainer_" + name;
    std::filesystem::remove_all(settings.out);
    return settings;
}

std::vector<float> numbers(Trainer& trainer) {
    const torch::Tensor flat = trainer.network().parameters().flat().detach().clone();
    return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
}

TEST(Trainer, GoesOnExactlyWhereItStopped) {
    for (const char* recipe : {"quick", "paper"}) {
        Trainer straight(tiny("straight", recipe));
        for (int k = 0; k < 24; ++k) straight.iterate();

        const TrainerSettings settings = tiny("stopped", recipe);
        {
            Trainer first(settings);
            EXPECT_FALSE(first.resume());
            for (int k = 0; k < 12; ++k) first.iterate();
            first.save();
        }
        Trainer second(settings);
        ASSERT_TRUE(second.resume());
        EXPECT_EQ(second.iteration(), 12);
        for (int k = 0; k < 12; ++k) second.iterate();
        EXPECT_EQ(numbers(straight), numbers(second)) << recipe;
    }
}

TEST(Trainer, IsAFunctionOfItsSeed) {
    TrainerSettings settings = tiny("seed");
    Trainer a(settings), b(settings);
    settings.seed = 2;
    Trainer c(settings);
    for (int k = 0; k < 5; ++k) {
        a.iterate();
        b.iterate();
        c.iterate();
    }
    EXPECT_EQ(numbers(a), numbers(b));
    EXPECT_NE(numbers(a), numbers(c));
}

TEST(Trainer, LowersTheGapOnStatesItNeverSaw) {
    TrainerSettings settings = tiny("learns");
    settings.iterations = 300;
    const SceneFactory factory(settings.model, settings.scenes, settings.seed);
    Validation validation(factory, settings.validation);
    Trainer trainer(settings);
    trainer.iterate();  // makes the scenes
    const double before = validation.measure(trainer.network()).sheet.median;
    while (trainer.iteration() < settings.iterations) trainer.iterate();
    const double after = validation.measure(trainer.network()).sheet.median;
    EXPECT_GT(before, 0.9);
    EXPECT_LT(after, 0.85);
    EXPECT_LT(validation.measure_solver(3).sheet.median, 0.5);
}

TEST(Trainer, WritesWeightsMetricsAndCheckpointAndStopsWhenTold) {
    TrainerSettings settings = tiny("files");
    settings.iterations = 1000000;
    settings.report_every = 5;
    Trainer trainer(settings);
    for (int k = 0; k < 5; ++k) trainer.iterate();
    const std::atomic<bool> stop{true};
    trainer.run(stop);
    EXPECT_EQ(trainer.iteration(), 5);
    const Weights weights = Weights::load(settings.out + "/weights.safetensors");
    EXPECT_TRUE(weights.config == settings.model);
    EXPECT_TRUE(std::filesystem::exists(settings.out + "/checkpoint.pt"));
}

TEST(Trainer, RefusesABrokenOrForeignCheckpoint) {
    TrainerSettings settings = tiny("broken");
    {
        Trainer trainer(settings);
        trainer.iterate();
        trainer.save();
    }
    TrainerSettings other = settings;
    other.model.width = 32;
    Trainer foreign(other);
    EXPECT_THROW(foreign.resume(), LoadError);
    std::filesystem::resize_file(settings.out + "/checkpoint.pt", 1000);
    Trainer trainer(settings);
    EXPECT_THROW(trainer.resume(), LoadError);
}

TEST(Trainer, RefusesSettingsThatCannotWork) {
    TrainerSettings settings = tiny("settings");
    settings.iterations = 0;
    EXPECT_THROW(Trainer{settings}, ArgumentError);
    settings = tiny("settings");
    settings.device = "abacus";
    EXPECT_THROW(Trainer{settings}, ArgumentError);
}

TEST(Recipe, PaperHalvesTheRateAndGrowsTheRollouts) {
    const Recipe paper = Recipe::named("paper", 128);
    EXPECT_DOUBLE_EQ(paper.learning_rate(29999, 0.2), 1e-4);
    EXPECT_DOUBLE_EQ(paper.learning_rate(60000, 0.5), 0.25e-4);
    EXPECT_EQ(paper.rollout(2999), 1);
    EXPECT_EQ(paper.rollout(3000), 2);
    EXPECT_EQ(paper.rollout(100000), 5);
    EXPECT_DOUBLE_EQ(paper.contact_weight(0.0), 5e3);
    EXPECT_DOUBLE_EQ(paper.contact_weight(1.0), 5e5);
    EXPECT_THROW(Recipe::named("secret", 32), ArgumentError);
}

TEST(Recipe, QuickWarmsUpAndDecays) {
    const Recipe quick = Recipe::named("quick", 32);
    EXPECT_NEAR(quick.learning_rate(0, 0.0), 2e-5, 1e-12);
    EXPECT_NEAR(quick.learning_rate(5000, 1.0), 4e-5, 1e-12);
    EXPECT_NEAR(quick.heal_share(0.0), 0.8, 1e-12);
    EXPECT_NEAR(quick.heal_share(1.0), 0.35, 1e-12);
}

TEST(SceneRandom, HasTheMomentsItPromises) {
    SceneRandom random(1);
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < 20000; ++k) {
        const double value = random.normal();
        sum += value;
        squares += value * value;
    }
    EXPECT_NEAR(sum / 20000, 0.0, 0.03);
    EXPECT_NEAR(squares / 20000, 1.0, 0.05);
    for (int k = 0; k < 100; ++k) EXPECT_NEAR(random.direction().norm(), 1.0, 1e-12);
}

}  // namespace
}  // namespace cloth
