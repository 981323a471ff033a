#include "gnn/train/trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>

#include "data/core/errors.h"
#include "tests/gnn/train/tiny_training.h"

namespace cloth::trainer_test {
namespace {

TrainerSettings tiny(const std::string& name, const std::string& recipe = "quick") {
    return test::tiny_training("trainer_" + name, recipe);
}

std::vector<float> numbers(Trainer& trainer) {
    const torch::Tensor flat = trainer.network().parameters().flat().detach().clone();
    return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
}

std::string message_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

void expect_equal_bits_if_resumed(const std::string& recipe,
                                  const std::function<void(Recipe&)>& change) {
    TrainerSettings settings = tiny("straight", recipe);
    change(settings.recipe);
    Trainer straight(settings);
    for (int k = 0; k < 24; ++k) straight.iterate();

    settings.out = tiny("stopped").out;
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

TEST(Trainer, GoesOnExactlyWhereItStopped) {
    for (const std::string& recipe : Recipe::names())
        expect_equal_bits_if_resumed(recipe, [](Recipe&) {});
    expect_equal_bits_if_resumed("kicks", [](Recipe& all) {
        all.kicks.share = 0.5;
        all.loss_iterations = 2;
        all.max_rollout = 3;
        all.rollout_growth = 4;
        all.heal_last = 0.0;
        all.mean_share = 0.5;
    });
}

TEST(Trainer, SavesTheMeanOfTheParametersAndTrainsOnTheLast) {
    TrainerSettings settings = tiny("last");
    Trainer last(settings);
    settings.out = tiny("mean").out;
    settings.recipe.mean_share = 1.0;
    Trainer mean(settings);
    std::vector<double> sum(numbers(last).size(), 0.0);
    for (int k = 0; k < 6; ++k) {
        last.iterate();
        mean.iterate();
        const std::vector<float> now = numbers(last);
        // the first iteration counts as the second does: both begin the mean
        if (k > 0)
            for (size_t i = 0; i < now.size(); ++i) sum[i] += static_cast<double>(now[i]);
    }
    EXPECT_EQ(numbers(last), numbers(mean));
    mean.save();
    EXPECT_EQ(numbers(last), numbers(mean)) << "after saving";
    Network saved(settings.model, torch::kCPU, 1);
    saved.import_weights(Weights::load(settings.out + "/weights.safetensors"));
    const torch::Tensor flat = saved.parameters().flat().detach();
    ASSERT_EQ(flat.numel(), static_cast<std::int64_t>(sum.size()));
    for (size_t i = 0; i < sum.size(); ++i)
        ASSERT_NEAR(flat.data_ptr<float>()[i], sum[i] / 5.0, 1e-5);
}

TEST(Trainer, ScenesOfABatchMayBeSharedByThreads) {
    TrainerSettings settings = tiny("one_thread", "kicks");
    settings.batch = 3;
    Trainer one(settings);
    settings.out = tiny("three_threads").out;
    settings.threads = 3;
    Trainer three(settings);
    for (int k = 0; k < 12; ++k) {
        one.iterate();
        three.iterate();
    }
    EXPECT_EQ(numbers(one), numbers(three));
}

TEST(Trainer, ABatchPassesTheNetworkAtOnceWithTheSameGradient) {
    TrainerSettings settings = tiny("one_by_one", "kicks");
    settings.batch = 3;
    Trainer one_by_one(settings);
    settings.out = tiny("at_once").out;
    settings.at_once = true;
    Trainer at_once(settings);
    one_by_one.iterate();
    at_once.iterate();
    const torch::Tensor a = one_by_one.network().parameters().gradient();
    const torch::Tensor b = at_once.network().parameters().gradient();
    EXPECT_LT((a - b).norm().item<double>(), 1e-5 * a.norm().item<double>());
    EXPECT_GT(a.norm().item<double>(), 0.0);
    for (int k = 0; k < 11; ++k) at_once.iterate();
    for (const float number : numbers(at_once)) ASSERT_TRUE(std::isfinite(number));
}

TEST(Trainer, TrainsAndResumesNetworksWithCoarseLevels) {
    for (const char* variant : {"hood", "hood_fast", "bistride"}) {
        TrainerSettings settings = tiny(std::string(variant) + "_straight", "kicks");
        settings.model = ModelConfig::variant_named(variant, 5);
        settings.model.width = 16;
        Trainer straight(settings);
        for (int k = 0; k < 8; ++k) straight.iterate();
        settings.out = tiny(std::string(variant) + "_stopped").out;
        {
            Trainer first(settings);
            for (int k = 0; k < 4; ++k) first.iterate();
            first.save();
        }
        EXPECT_TRUE(Weights::load(settings.out + "/weights.safetensors").config == settings.model);
        Trainer second(settings);
        ASSERT_TRUE(second.resume());
        for (int k = 0; k < 4; ++k) second.iterate();
        EXPECT_EQ(numbers(straight), numbers(second)) << variant;
    }
}

TEST(Trainer, ValidatesNetworksWithCoarseLevelsByRollouts) {
    TrainerSettings settings = tiny("hood_validated");
    settings.model = ModelConfig::variant_named("hood_fast", 5);
    settings.model.width = 16;
    settings.iterations = 8;
    settings.report_every = 4;
    settings.validate_every = 0.0;
    settings.validation_share = 1.0;
    const std::atomic<bool> go{false};
    Trainer(settings).run(go);
    EXPECT_TRUE(std::filesystem::exists(settings.out + "/metrics.csv"));
    EXPECT_TRUE(std::filesystem::exists(settings.out + "/rollouts.csv"));
}

TEST(Trainer, EachStateOfTheRecipeChangesTheTraining) {
    const auto trained = [](const std::function<void(Recipe&)>& change) {
        TrainerSettings settings = tiny("states");
        change(settings.recipe);
        Trainer trainer(settings);
        for (int k = 0; k < 12; ++k) trainer.iterate();
        return numbers(trainer);
    };
    const std::vector<float> plain = trained([](Recipe&) {});
    EXPECT_EQ(trained([](Recipe&) {}), plain);
    EXPECT_NE(trained([](Recipe& r) { r.kicks.share = 1.0; }), plain);
    EXPECT_NE(trained([](Recipe& r) { r.position_weight = 1.0; }), plain);
    EXPECT_NE(trained([](Recipe& r) { r.target_iterations = 12; }), plain);
    EXPECT_NE(trained([](Recipe& r) { r.loss_iterations = 1; }), plain);
    EXPECT_NE(trained([](Recipe& r) { r.heal_first = r.heal_last = 0.0; }), plain);
    EXPECT_NE(trained([](Recipe& r) { r.max_rollout = 2, r.rollout_growth = 1; }), plain);
}

TEST(Trainer, ValidationFillsItsColumnsAndChangesNoBits) {
    TrainerSettings settings = tiny("validated");
    settings.iterations = 12;
    settings.report_every = 4;
    settings.validate_every = 0.0;
    settings.validation_share = 1.0;
    const std::atomic<bool> go{false};
    Trainer validated(settings);
    validated.run(go);
    std::ifstream csv(settings.out + "/metrics.csv");
    std::string line;
    std::vector<std::string> lines;
    while (std::getline(csv, line)) lines.push_back(line);
    ASSERT_EQ(lines.size(), 4u) << "a header and rows at 4, 8 and 12 iterations";
    for (size_t row = 1; row < lines.size(); ++row) {
        EXPECT_EQ(std::count(lines[row].begin(), lines[row].end(), ','),
                  std::count(lines[0].begin(), lines[0].end(), ','));
        // garments are missing here: 3 columns of steps and 9 of rollouts. The recipe gives the
        // error of position no weight.
        std::stringstream cells(lines[row]);
        int empty = 0;
        for (std::string cell; std::getline(cells, cell, ',');) empty += cell.empty();
        EXPECT_EQ(empty, 13) << lines[row];
    }
    settings.out = tiny("plain").out;
    settings.validation_share = 0.0;
    Trainer plain(settings);
    plain.run(go);
    EXPECT_FALSE(std::filesystem::exists(settings.out + "/references"));
    EXPECT_EQ(numbers(validated), numbers(plain));
}

TEST(Trainer, StartsFromWeightsAndKeepsTheirStatistics) {
    TrainerSettings settings = tiny("first");
    Trainer first(settings);
    for (int k = 0; k < 12; ++k) first.iterate();
    first.save();
    const Weights before = first.weights();

    settings.start_weights = settings.out + "/weights.safetensors";
    settings.out = tiny("second").out;
    settings.seed = 7;
    std::vector<float> straight;
    {
        Trainer second(settings);
        EXPECT_EQ(numbers(second), numbers(first));
        for (int k = 0; k < 6; ++k) second.iterate();
        second.save();
        for (int k = 0; k < 6; ++k) second.iterate();
        straight = numbers(second);
    }
    Trainer resumed(settings);
    ASSERT_TRUE(resumed.resume());
    for (int k = 0; k < 6; ++k) resumed.iterate();
    EXPECT_EQ(numbers(resumed), straight);
    EXPECT_NE(numbers(resumed), numbers(first));
    for (const char* name : {"statistics.node.mean", "statistics.edge.deviation"})
        EXPECT_EQ(resumed.weights().tensor(name).data, before.tensor(name).data);
}

TEST(Trainer, GoesOnWithTheStatisticsItHadWhateverTheWeightsAreNow) {
    TrainerSettings settings = tiny("statistics_first");
    {
        Trainer first(settings);
        first.iterate();
        first.save();
    }
    const std::string file = settings.out + "/weights.safetensors";
    settings.start_weights = testing::TempDir() + "trainer_statistics.safetensors";
    std::filesystem::copy_file(file, settings.start_weights,
                               std::filesystem::copy_options::overwrite_existing);
    settings.out = tiny("statistics_second").out;
    std::vector<float> straight;
    {
        Trainer second(settings);
        for (int k = 0; k < 3; ++k) second.iterate();
        second.save();
        for (int k = 0; k < 3; ++k) second.iterate();
        straight = numbers(second);
    }
    Weights other = Weights::load(file);
    for (float& value : other.tensors.at("statistics.node.mean").data) value += 1.0f;
    other.save(settings.start_weights);
    for (const bool is_there : {true, false}) {
        if (!is_there) std::filesystem::remove(settings.start_weights);
        Trainer resumed(settings);
        ASSERT_TRUE(resumed.resume());
        for (int k = 0; k < 3; ++k) resumed.iterate();
        EXPECT_EQ(numbers(resumed), straight) << is_there;
    }
    Trainer anew(settings);
    EXPECT_THROW(anew.iterate(), LoadError);
}

TEST(Trainer, NamesTheFileAndTheOptionsOfWeightsOfAnotherNetwork) {
    TrainerSettings settings = tiny("other_weights");
    Trainer first(settings);
    first.iterate();
    first.save();
    settings.start_weights = settings.out + "/weights.safetensors";
    settings.out = tiny("other_network").out;
    settings.model = ModelConfig::variant_named("baseline", 8);
    settings.model.width = 32;
    Trainer second(settings);
    EXPECT_EQ(
        message_of([&] { second.iterate(); }),
        "--weights " + settings.start_weights +
            ": is of another network: --sampled-edges 4 (asked for 0), --steps 4 (asked for "
            "8), --variant fast (asked for baseline), --width 16 (asked for 32). Remedy: give "
            "the options of its network: --variant fast --width 16 --steps 4 "
            "--sampled-edges 4");
}

TEST(Trainer, GoesOnFromWeightsForAnotherTimeStep) {
    TrainerSettings settings = tiny("thirtieth");
    Trainer first(settings);
    for (int k = 0; k < 3; ++k) first.iterate();
    first.save();
    settings.start_weights = settings.out + "/weights.safetensors";
    settings.out = tiny("sixtieth").out;
    settings.model.dt = 1.0 / 60.0;
    Trainer second(settings);
    EXPECT_EQ(numbers(second), numbers(first));
    second.iterate();
    EXPECT_EQ(second.weights().config.dt, 1.0 / 60.0);
    EXPECT_NE(numbers(second), numbers(first));
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
    settings.iterations = 600;
    settings.validation.sheet_states = 12;
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

TEST(Trainer, TellsWhichSettingsAreNotThoseOfTheCheckpoint) {
    TrainerSettings settings = tiny("differences", "kicks");
    settings.batch = 2;
    {
        Trainer trainer(settings);
        trainer.iterate();
        trainer.save();
    }
    const auto refusal = [&](const std::function<void(TrainerSettings&)>& change) {
        TrainerSettings other = settings;
        change(other);
        Trainer trainer(other);
        const std::string message = message_of([&] { trainer.resume(); });
        const std::string start = settings.out + "/checkpoint.pt, settings: the training was ";
        EXPECT_EQ(message.substr(0, start.size()), start) << message;
        return message.substr(start.size(), message.find(". Remedy") - start.size());
    };
    EXPECT_EQ(refusal([](TrainerSettings& s) { s.batch = 1; }), "started with --batch 2 (now 1)");
    EXPECT_EQ(refusal([](TrainerSettings& s) { s.batch = 3; }), "started with --batch 2 (now 3)");
    EXPECT_EQ(refusal([](TrainerSettings& s) { s.scenes.proxies = true; }),
              "started with --proxies none (now given)");
    EXPECT_EQ(refusal([](TrainerSettings& s) {
                  s.model.width = 32;
                  s.model.dt = 1.0 / 60.0;
                  s.recipe.heal_last = 0.125;
                  s.recipe.loss = LossKind::log;
                  s.recipe.mean_share = 0.5;
                  s.seed = 9;
                  s.start_weights = "some.safetensors";
              }),
              "started with --healed-last 0.35 (now 0.125), --loss both (now log), --mean-share "
              "none (now 0.5), --rate 30 (now 60), --seed 1 (now 9), --weights none (now given), "
              "--width 16 (now 32)");
    EXPECT_EQ(refusal([](TrainerSettings& s) {
                  s.recipe = Recipe::named("own", 16);
                  s.scenes.garments = {"my/shirt.obj"};
              }).rfind("started with --garment, and sizes of sheets: long_top_1000", 0),
              0u);
}

TEST(Trainer, LooksUpWhatItWillValidate) {
    const auto refusal = [](const std::function<void(TrainerSettings&)>& change) {
        TrainerSettings changed = tiny("looked_up");
        change(changed);
        return message_of([&] { Trainer trainer(changed); });
    };
    EXPECT_NE(refusal([](TrainerSettings& s) {
                  s.rollouts.clips = {"01_0l"};
              }).find("--validation-clips: 01_0l"),
              std::string::npos);
    EXPECT_NE(refusal([](TrainerSettings& s) {
                  s.rollouts.garments = {"toga"};
              }).find("--validation-garments: toga"),
              std::string::npos);
    EXPECT_NE(refusal([](TrainerSettings& s) {
                  s.references = "/proc/references";
              }).find("--references /proc/references: cannot be written"),
              std::string::npos);
    EXPECT_NE(refusal([](TrainerSettings& s) { s.model.width = 20; }).find("--width 20"),
              std::string::npos);
    EXPECT_EQ(refusal([](TrainerSettings& s) {
                  s.rollouts.clips = {"01_0l"};
                  s.model.width = 20;
                  s.validation_share = 0.0;
              }),
              "")
        << "without validation";
}

TEST(Trainer, LeavesCellsEmptyOfWhatTheLossDoesNotMeasure) {
    TrainerSettings settings = tiny("unmeasured", "paper");
    settings.iterations = 4;
    settings.report_every = 2;
    settings.validation_share = 0.0;
    Trainer(settings).run(std::atomic<bool>{false});
    std::ifstream csv(settings.out + "/metrics.csv");
    std::string head, line, cell;
    std::getline(csv, head);
    int rows = 0;
    for (; std::getline(csv, line); ++rows) {
        std::stringstream names(head), cells(line);
        for (std::string name; std::getline(names, name, ',');) {
            std::getline(cells, cell, ',');
            if (name == "gap_training_median" || name == "error_training_median") {
                EXPECT_EQ(cell, "") << name;
            }
            if (name == "loss") {
                EXPECT_NE(cell, "");
            }
        }
    }
    EXPECT_EQ(rows, 2);
}

TEST(Trainer, RefusesSettingsThatCannotWork) {
    TrainerSettings settings = tiny("settings");
    settings.iterations = 0;
    EXPECT_THROW(Trainer{settings}, ArgumentError);
    const auto refuses = [](auto change) {
        TrainerSettings changed = tiny("settings");
        change(changed);
        EXPECT_THROW(Trainer{changed}, ArgumentError);
    };
    refuses([](TrainerSettings& s) { s.device = "abacus"; });
    refuses([](TrainerSettings& s) { s.validation_share = 1.5; });
    refuses([](TrainerSettings& s) { s.report_every = 0; });
    refuses([](TrainerSettings& s) { s.save_every = -1.0; });
    refuses([](TrainerSettings& s) { s.recipe.kicks.share = 2.0; });
    refuses([](TrainerSettings& s) { s.recipe.target_iterations = 0; });
    refuses([](TrainerSettings& s) { s.scenes.garment_share = -0.5; });
    refuses([](TrainerSettings& s) { s.validation.minimum_iterations = 0; });
    refuses([](TrainerSettings& s) { s.rollouts.frames = 0; });
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

TEST(Recipe, NamesAreThoseThatItKnows) {
    std::set<std::string> descriptions;
    for (const std::string& name : Recipe::names()) {
        const Recipe recipe = Recipe::named(name, 32);
        EXPECT_EQ(recipe.name, name);
        EXPECT_NO_THROW(recipe.check());
        descriptions.insert(recipe.describe());
    }
    EXPECT_EQ(descriptions.size(), Recipe::names().size());
}

TEST(Recipe, KicksIsQuickWithKicksAndPositions) {
    const Recipe kicks = Recipe::named("kicks", 32), quick = Recipe::named("quick", 32);
    EXPECT_DOUBLE_EQ(kicks.kicks.share, 0.2);
    EXPECT_DOUBLE_EQ(kicks.position_weight, 1.0);
    EXPECT_DOUBLE_EQ(quick.kicks.share, 0.0);
    EXPECT_DOUBLE_EQ(quick.position_weight, 0.0);
    EXPECT_DOUBLE_EQ(kicks.base_rate, quick.base_rate);
    EXPECT_EQ(kicks.target_iterations, 6);
    const Recipe own = Recipe::named("own", 32);
    EXPECT_LT(own.base_rate, kicks.base_rate);
    EXPECT_DOUBLE_EQ(own.heal_share(1.0), 0.0);
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
}  // namespace cloth::trainer_test
