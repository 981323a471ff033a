#include "gnn/model/weights.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "data/core/errors.h"
#include "gnn/model/engine_weights.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::weights_test {
namespace {

Weights small_weights() {
    Weights weights;
    weights.config = ModelConfig::variant_named("fast");
    weights.config.width = 4;
    weights.config.steps = 2;
    float value = 0.0f;
    for (const auto& shapes : {parameter_shapes(weights.config), statistics_shapes(weights.config)})
        for (const auto& [name, shape] : shapes) {
            size_t count = 1;
            for (int size : shape) count *= static_cast<size_t>(size);
            WeightTensor& tensor = weights.tensors[name];
            tensor.shape = shape;
            for (size_t i = 0; i < count; ++i) tensor.data.push_back(value += 0.25f);
        }
    return weights;
}

ModelConfig small_config() {
    ModelConfig config = ModelConfig::variant_named("fast", 2);
    config.width = 16;
    return config;
}

class WeightsFile : public testing::Test {
 protected:
    void SetUp() override {
        m_file = testing::TempDir() + "weights_" +
                 testing::UnitTest::GetInstance()->current_test_info()->name() + ".safetensors";
        small_weights().save(m_file);
        std::ifstream in(m_file, std::ios::binary);
        m_bytes.assign(std::istreambuf_iterator<char>(in), {});
    }
    void TearDown() override { std::filesystem::remove(m_file); }

    void write(const std::string& bytes) const { std::ofstream(m_file, std::ios::binary) << bytes; }
    void replace(const std::string& from, const std::string& to) {
        ASSERT_EQ(from.size(), to.size());
        const size_t at = m_bytes.find(from);
        ASSERT_NE(at, std::string::npos);
        write(m_bytes.replace(at, from.size(), to));
    }
    /// The message that loading fails with.
    std::string refusal() const {
        try {
            Weights::load(m_file);
        } catch (const LoadError& error) {
            return error.what();
        }
        ADD_FAILURE() << "the file was accepted";
        return "";
    }

    std::string m_file, m_bytes;
};

TEST_F(WeightsFile, ReadsWhatWasWritten) {
    const Weights original = small_weights(), loaded = Weights::load(m_file);
    EXPECT_TRUE(loaded.config == original.config);
    ASSERT_EQ(loaded.tensors.size(), original.tensors.size());
    for (const auto& [name, tensor] : original.tensors) {
        EXPECT_EQ(loaded.tensor(name).shape, tensor.shape);
        EXPECT_EQ(loaded.tensor(name).data, tensor.data);
    }
    EXPECT_FALSE(std::filesystem::exists(m_file + ".tmp"));
}

TEST_F(WeightsFile, NamesWhatWasLoadedAfterItself) {
    EXPECT_FALSE(small_weights().called);
    EXPECT_EQ(small_weights().solver_name(), "fast");
    Weights loaded = Weights::load(m_file);
    EXPECT_EQ(loaded.called, "weights_NamesWhatWasLoadedAfterItself");
    EXPECT_EQ(loaded.solver_name(), loaded.called);
    loaded.called = "renamed";
    loaded.save(m_file);
    std::ifstream in(m_file, std::ios::binary);
    EXPECT_EQ(m_bytes, std::string(std::istreambuf_iterator<char>(in), {}))
        << "a file's name is no part of what is in it";
}

TEST_F(WeightsFile, RefusesEveryTruncation) {
    for (size_t length = 0; length < m_bytes.size(); length += 1 + m_bytes.size() / 97) {
        write(m_bytes.substr(0, length));
        EXPECT_NE(refusal().find(m_file), std::string::npos) << "length " << length;
    }
}

TEST_F(WeightsFile, RefusesAnotherVersion) {
    replace("\"version\":\"1\"", "\"version\":\"9\"");
    EXPECT_NE(refusal().find("version"), std::string::npos);
}

TEST_F(WeightsFile, RefusesAMissingTensorByName) {
    replace("\"decoder.output.bias\"", "\"decoder.output.bins\"");
    EXPECT_NE(refusal().find("tensor decoder.output.bias: is missing"), std::string::npos);
}

TEST_F(WeightsFile, RefusesAnUnknownTensorByName) {
    TensorFile raw = TensorFile::load(m_file);
    raw.tensors["decoder.extra"] = {{1}, {0.5f}};
    raw.save(m_file);
    EXPECT_NE(refusal().find("tensor decoder.extra: is not one of the configuration"),
              std::string::npos);
}

TEST_F(WeightsFile, RefusesBytesOfNoTensorOrOfTwo) {
    const std::string bytes = m_bytes;
    write(bytes + "more");
    EXPECT_NE(refusal().find("has 4 bytes behind its last tensor"), std::string::npos);
    replace("[80,96]", "[16,32]");
    EXPECT_NE(refusal().find("shares bytes with another tensor"), std::string::npos);
    m_bytes = bytes;
    replace("[0,16]", "[1,17]");
    EXPECT_NE(refusal().find("does not begin where the one before it ends"), std::string::npos);
}

TEST_F(WeightsFile, RefusesATensorOfAnotherShapeByName) {
    replace("\"shape\":[3,4]", "\"shape\":[4,3]");
    const std::string message = refusal();
    EXPECT_NE(message.find("decoder.output.weight"), std::string::npos) << message;
    EXPECT_NE(message.find("[4,3]"), std::string::npos) << message;
}

TEST_F(WeightsFile, RefusesANumberThatIsNotFinite) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    m_bytes.replace(m_bytes.size() - sizeof nan, sizeof nan, reinterpret_cast<const char*>(&nan),
                    sizeof nan);
    write(m_bytes);
    EXPECT_NE(refusal().find("not finite"), std::string::npos);
}

TEST_F(WeightsFile, RefusesADeviationThatCannotDivide) {
    for (const float deviation : {0.0f, -1.0f, 1e-40f}) {
        Weights weights = small_weights();
        weights.tensors["statistics.edge.deviation"].data[1] = deviation;
        EXPECT_THROW(weights.save(m_file), ArgumentError) << deviation;
    }
}

TEST_F(WeightsFile, RefusesAFolder) {
    std::filesystem::remove(m_file);
    std::filesystem::create_directory(m_file);
    EXPECT_NE(refusal().find("is a folder"), std::string::npos);
    std::filesystem::remove(m_file);
}

TEST_F(WeightsFile, RefusesAFileThatIsSomethingElse) {
    write(std::string(4096, 'x'));
    EXPECT_NE(refusal().find("safetensors"), std::string::npos);
    std::filesystem::remove(m_file);
    EXPECT_NE(refusal().find("cannot be opened"), std::string::npos);
}

TEST_F(WeightsFile, RefusesAConfigurationOutOfRange) {
    replace("\\\"steps\\\":2", "\\\"steps\\\":0");
    EXPECT_NE(refusal().find("steps"), std::string::npos);
}

TEST(EngineWeights, OfMemoryAreCheckedAsThoseOfAFile) {
    const auto message = [](const auto& change) {
        Weights weights = test::random_weights(small_config());
        change(weights.tensors);
        try {
            const EngineWeights packed(weights);
        } catch (const ArgumentError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    using Tensors = std::map<std::string, WeightTensor>;
    EXPECT_EQ(message([](Tensors&) {}), "");
    EXPECT_NE(message([](Tensors& all) {
                  all.at("decoder.output.weight").data.pop_back();
              }).find("decoder.output.weight"),
              std::string::npos);
    EXPECT_NE(message([](Tensors& all) {
                  all.at("step.0.node.output.bias").data[3] =
                      std::numeric_limits<float>::quiet_NaN();
              }).find("step.0.node.output.bias: element 3 is not finite"),
              std::string::npos);
    EXPECT_NE(message([](Tensors& all) {
                  all.at("statistics.body.deviation").data[0] = 0.0f;
              }).find("statistics.body.deviation: element 0 is not positive"),
              std::string::npos);
    EXPECT_NE(message([](Tensors& all) {
                  all.erase("encoder.world.first.bias");
              }).find("encoder.world.first.bias: is missing"),
              std::string::npos);
}

TEST(Weights, AreNotSavedIncomplete) {
    Weights weights = small_weights();
    weights.tensors.erase("decoder.output.bias");
    EXPECT_THROW(weights.save(testing::TempDir() + "incomplete.safetensors"), ArgumentError);
}

TEST(ModelConfig, VariantsAreThoseOfThePaper) {
    EXPECT_EQ(ModelConfig::variant_named("baseline").sampled_edges, 0);
    EXPECT_TRUE(ModelConfig::variant_named("sampling").body_updates);
    EXPECT_FALSE(ModelConfig::variant_named("reduction").world_every_step);
    EXPECT_EQ(ModelConfig::variant_named("fast").sampled_edges, 4);
    EXPECT_THROW(ModelConfig::variant_named("faster"), ArgumentError);
}

TEST(ModelConfig, VariantsWithCoarseLevelsDifferInSamplingReductionAndPooling) {
    const ModelConfig hood = ModelConfig::variant_named("hood");
    EXPECT_EQ(hood.steps, 15);
    EXPECT_EQ(hood.level_schedule, down_and_up(15, 2));
    EXPECT_EQ(hood.used_levels(), (std::vector<int>{0, 1, 2}));
    EXPECT_TRUE(hood.uses_after(2, 10));
    EXPECT_FALSE(hood.uses_after(2, 11));
    EXPECT_FALSE(hood.uses_after(0, 14));
    const ModelConfig fast = ModelConfig::variant_named("hood_fast", 8, 3);
    EXPECT_EQ(fast.sampled_edges, 4);
    EXPECT_FALSE(fast.world_every_step);
    EXPECT_EQ(coarsest_level(fast.level_schedule), 3);
    EXPECT_EQ(ModelConfig::variant_named("bistride").pooling, Pooling::bistride);
    EXPECT_EQ(ModelConfig::variant_named("fast", 6).steps, 6);
    EXPECT_EQ(ModelConfig::variant_named("fast").used_levels(), std::vector<int>{0});
    EXPECT_THROW(ModelConfig::variant_named("hood", 4), ArgumentError);
}

TEST(ModelConfig, ItsTextHasLevelsOnlyWhereTheNetworkHas) {
    EXPECT_EQ(ModelConfig::variant_named("fast").to_json().find("level"), std::string::npos);
    for (const char* variant : {"hood", "hood_fast", "bistride"}) {
        const ModelConfig config = ModelConfig::variant_named(variant, 9, 3);
        const ModelConfig read = ModelConfig::from_json(config.to_json(), "here");
        EXPECT_TRUE(read == config);
        EXPECT_EQ(read.level_schedule, config.level_schedule);
        EXPECT_EQ(read.pooling, config.pooling);
    }
}

TEST(ModelConfig, RefusesLevelsThatCannotBe) {
    const std::string text = ModelConfig::variant_named("hood", 5).to_json();
    const auto refuses = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const size_t at = changed.find(from);
        ASSERT_NE(at, std::string::npos);
        changed.replace(at, from.size(), to);
        EXPECT_THROW(ModelConfig::from_json(changed, "here"), LoadError) << changed;
    };
    refuses("[0,1]", "[0,7]");
    refuses("[0,1]", "[0]]");
    refuses("[0,1],", "");
    refuses("[0,1]", "\"mesh\"");
    refuses("\"hood\",\"sampled", "\"pool\",\"sampled");
    refuses("\"level_schedule\"", "\"level_schedul\"");
}

TEST(ModelConfig, IntegersAreNotMadeOfOtherNumbers) {
    const std::string text = ModelConfig::variant_named("sampling", 5).to_json();
    for (const char* number : {"-1e308", "1e20", "5.5", "4294967301", "-4294967291",
                               "18446744073709551621", "true", "\"5\"", "[5]"})
        for (const std::string field : {"\"steps\":", "\"schedule_seed\":"}) {
            const size_t at = text.find(field) + field.size();
            std::string changed = text;
            changed.replace(at, text.find(',', at) - at, number);
            if (field == "\"schedule_seed\":" && std::string(number) == "4294967301") {
                EXPECT_EQ(ModelConfig::from_json(changed, "here").schedule_seed, 4294967301u);
                continue;
            }
            EXPECT_THROW(ModelConfig::from_json(changed, "here"), LoadError) << changed;
        }
}

TEST(ModelConfig, SurvivesItsText) {
    ModelConfig config = ModelConfig::variant_named("sampling");
    config.width = 48;
    config.features.force_features = false;
    EXPECT_TRUE(ModelConfig::from_json(config.to_json(), "here") == config);
    EXPECT_THROW(ModelConfig::from_json("{}", "here"), LoadError);
}

}  // namespace
}  // namespace cloth::weights_test
