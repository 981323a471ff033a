#include "gnn/train/skinning_trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>

#include "data/body/garment_skinning.h"
#include "data/core/errors.h"
#include "gnn/skinning/skinning_network.h"
#include "tests/gnn/skinning/random_skinning.h"

namespace cloth::skinning_trainer_test {

using namespace cloth::test;

namespace {

SkinningTrainerSettings tiny(const std::string& name) {
    SkinningTrainerSettings settings;
    settings.motions = {"01_03", "Boxing_Toes"};
    settings.model.layers = {32, 16};
    settings.model.ages = {0, 1, 3};
    settings.sequences = 2;
    settings.frames = 2;
    settings.iterations = 40;
    settings.report_every = 5;
    settings.validate_every = 0;
    settings.out = testing::TempDir() + "skinning_" + name;
    std::filesystem::remove_all(settings.out);
    return settings;
}

std::string read(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(SkinningTrainer, TheEngineComputesWhatLibTorchDoes) {
    SkinningTrainer trainer(tiny("engine"));
    for (int k = 0; k < 3; ++k) trainer.iterate();
    const SkinningWeights weights = trainer.weights();
    const auto body = std::make_shared<const Body>(walker()->body());
    const SkinningClips clips(body, {"01_01"}, weights.config);
    SkinningWindow window = clips.window(0, 40, 12);
    window.features[3] *= 100.0;  // far from what it was trained on: clamped
    const std::vector<Points> expected = trainer.displacements(window.features);
    SkinningNetwork network(weights);
    double size = 0.0;
    for (size_t k = 0; k < expected.size(); ++k) {
        Points answer;
        network.evaluate(window.features[k], answer);
        // In units of the network's output, which are centimetres.
        EXPECT_LT((answer - expected[k]).cwiseAbs().maxCoeff() / weights.config.scale, 1e-5) << k;
        size = std::max(size, answer.cwiseAbs().maxCoeff());
    }
    EXPECT_GT(size, 1e-4);
}

TEST(SkinningTrainer, TheGradientIsThatOfTheLoss) {
    const Garment loaded = load_garment("tshirt_1000");
    const GarmentSkinning skinning = skin_garment(loaded.rest().vertices, *walker());
    const double dt = 1.0 / 30.0;
    SkinningLoss evaluator(loaded, dt);
    Points displacement(loaded.vertex_count(), 3), direction = displacement;
    for (Eigen::Index k = 0; k < displacement.size(); ++k) {
        displacement.data()[k] = 2e-3 * std::sin(0.37 * static_cast<double>(k));
        direction.data()[k] = std::cos(1.91 * static_cast<double>(k));
    }
    const auto posed = [&](double time, const Points& moved) {
        return skin_points(skinning.worn() + moved, skinning.weights(),
                           walker()->skin_matrices(time));
    };
    const double time = 2.0;
    const Points before = posed(time - dt, displacement), now = posed(time, displacement);
    for (const LossKind kind : {LossKind::energy, LossKind::log}) {
        const auto loss_at = [&](double step, LossValue& loss) {
            const Points moved = displacement + step * direction;
            evaluator.evaluate(kind, walker()->obstacle(time, time + dt), 5e5, before, now,
                               posed(time + dt, moved), loss);
            return loss.value;
        };
        LossValue loss, above, below;
        loss_at(0.0, loss);
        const double slope =
            unskinned(loss.gradient, skinning.weights(), walker()->skin_matrices(time + dt))
                .cwiseProduct(direction)
                .sum();
        const double h = 1e-7;
        const double differences = (loss_at(h, above) - loss_at(-h, below)) / (2.0 * h);
        EXPECT_NEAR(slope, differences, 1e-4 * std::abs(differences) + 1e-6);
        EXPECT_GT(std::abs(slope), 1e-3);
    }
}

TEST(SkinningTrainer, TheLossFalls) {
    SkinningTrainerSettings settings = tiny("falls");
    settings.iterations = 120;
    settings.learning_rate = 3e-3;
    settings.contact_first = settings.contact_last;
    SkinningTrainer trainer(settings);
    const SkinningValidation before = trainer.validate();
    for (int k = 0; k < 120; ++k) trainer.iterate();
    const SkinningValidation after = trainer.validate();
    EXPECT_LT(after.energy, before.energy - 0.1);
    EXPECT_LT(after.terms.contact, 0.8 * before.terms.contact);
}

TEST(SkinningTrainer, ResumedItGivesEqualBits) {
    SkinningTrainer straight(tiny("straight"));
    for (int k = 0; k < 12; ++k) straight.iterate();
    const SkinningTrainerSettings settings = tiny("resumed");
    {
        SkinningTrainer first(settings);
        EXPECT_FALSE(first.resume());
        for (int k = 0; k < 5; ++k) first.iterate();
        first.save();
    }
    SkinningTrainer second(settings);
    ASSERT_TRUE(second.resume());
    EXPECT_EQ(second.iteration(), 5);
    for (int k = 0; k < 7; ++k) second.iterate();
    const SkinningWeights a = straight.weights(), b = second.weights();
    for (const auto& [name, tensor] : a.tensors)
        EXPECT_EQ(tensor.data, b.tensor(name).data) << name;
}

TEST(SkinningTrainer, StoppedItSavesWithARowAndGoesOn) {
    const SkinningTrainerSettings settings = tiny("stopped");
    {
        SkinningTrainer trainer(settings);
        trainer.run(std::atomic<bool>{true});
        EXPECT_EQ(trainer.iteration(), 5);
    }
    const std::string rows = read(settings.out + "/metrics.csv");
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 2) << rows;
    SkinningTrainer trainer(settings);
    ASSERT_TRUE(trainer.resume());
    trainer.run(std::atomic<bool>{false});
    EXPECT_EQ(trainer.iteration(), 40);
    const std::string all = read(settings.out + "/metrics.csv");
    EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 1 + 40 / 5) << all;
    EXPECT_EQ(all.rfind(rows, 0), 0u) << "the first row is kept";
    EXPECT_EQ(SkinningWeights::load(settings.out + "/weights.safetensors").config.garment,
              "tshirt_1000");
}

TEST(SkinningTrainer, RefusesWhatItCannotUse) {
    const auto refuses = [](const auto& change) {
        SkinningTrainerSettings settings = tiny("refused");
        change(settings);
        try {
            SkinningTrainer trainer(settings);
        } catch (const ArgumentError&) {
            return true;
        } catch (const LoadError&) {
            return true;
        }
        return false;
    };
    EXPECT_TRUE(refuses([](auto& s) { s.iterations = 0; }));
    EXPECT_TRUE(refuses([](auto& s) { s.loss = LossKind::both; }));
    EXPECT_TRUE(refuses([](auto& s) { s.sequences = 0; }));
    EXPECT_TRUE(refuses([](auto& s) { s.learning_rate = 1.0; }));
    EXPECT_TRUE(refuses([](auto& s) { s.garment = "no such garment"; }));
    EXPECT_TRUE(refuses([](auto& s) { s.motions = {"no such motion"}; }));
    EXPECT_TRUE(refuses([](auto& s) { s.model.ages = {1, 2}; }));

    SkinningTrainerSettings settings = tiny("other");
    SkinningTrainer(settings).save();
    settings.frames = 3;
    SkinningTrainer other(settings);
    EXPECT_THROW(other.resume(), LoadError);
    std::ofstream(settings.out + "/checkpoint.pt") << "broken";
    EXPECT_THROW(other.resume(), LoadError);
}

}  // namespace

}  // namespace cloth::skinning_trainer_test
