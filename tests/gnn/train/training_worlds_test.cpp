#include "gnn/train/training_worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "data/body/body.h"
#include "data/core/errors.h"
#include "data/files/garment_assets.h"
#include "gnn/train/body_world.h"
#include "gnn/train/validation_names.h"

namespace cloth::training_worlds_test {

TEST(TrainingGarments, AreCommittedNotTooLargeAndLeaveOneOut) {
    const std::vector<std::string> names = training_garments();
    for (const std::string& name : names) {
        EXPECT_LE(load_garment_mesh(name).vertices.rows(), 4120) << name;
        EXPECT_EQ(name.find("tank_top"), std::string::npos) << "the unseen garment";
    }
    for (const std::string& name : garment_names())
        if (name.find("tank_top") == std::string::npos && name != "dress") {
            EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
        }
    EXPECT_EQ(names.back(), "tshirt");
}

TEST(SceneFactory, GarmentsStartAsTheyAreWorn) {
    SceneSettings settings;
    settings.garments = {"skirt_1000"};
    settings.motions = {"01_03"};
    const SceneFactory factory(ModelConfig::variant_named("fast"), settings, 1);
    ASSERT_TRUE(factory.has_garments());
    const auto scene = factory.make_garment(1, "01_01", 0);
    EXPECT_EQ(scene->state.x, load_garment_start("skirt_1000").x);
    EXPECT_EQ(scene->garment().rest().vertices, load_garment_mesh("skirt_1000").vertices);
    EXPECT_EQ(scene->garment().name(), "skirt_1000");
}

TEST(SceneFactory, ScenesWithProxiesStartWhereTheProxyShowsTheGarment) {
    SceneSettings settings;
    settings.proxies = true;
    settings.garment_share = 1.0;
    settings.shape_share = 1.0;
    settings.garments = {"skirt", "skirt_1000"};
    settings.motions = {"01_03"};
    const SceneFactory factory(ModelConfig::variant_named("fast"), settings, 1);
    const auto scene = factory.make_garment(1, "01_01", 0);
    ASSERT_TRUE(scene->parts().proxy);
    EXPECT_EQ(scene->parts().proxy->rest().vertices, load_garment_mesh("skirt_1000").vertices);
    EXPECT_FALSE(factory.make_garment(1, "01_01", 1)->parts().proxy) << "is coarse itself";
    for (int frame = 0; frame < 3; ++frame) {
        scene->prepare(5e5);
        const Points base = scene->features().base;
        scene->prepare(5e5);
        EXPECT_EQ(scene->features().base, base) << "depends on the state alone";
        Points x = base;
        const double before = scene->potential().value(base);
        EXPECT_LT(scene->refine(x, 3), before);
        const double edge = scene->parts().proxy->mean_edge_length();
        EXPECT_LT((x - base).rowwise().norm().maxCoeff(), edge) << "it is near the minimum";
        ASSERT_TRUE(scene->advance(x));
    }
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
        const auto shaped = factory.make(seed);  // a proxy of another shape is in its place, too
        EXPECT_EQ(shaped->parts().proxy != nullptr, shaped->garment().name() == "skirt");
    }
}

TEST(TrainingGarments, ThoseOfProxiesHaveOne) {
    SceneSettings settings;
    settings.proxies = true;
    settings.motions = {"01_03"};
    settings.garments = proxied_garments();
    const SceneFactory factory(ModelConfig::variant_named("fast"), settings, 1);
    ASSERT_EQ(factory.garment_names(), proxied_garments());
    for (size_t k = 0; k < proxied_garments().size(); ++k) {
        const auto scene = factory.make_garment(1, "01_01", k);
        ASSERT_TRUE(scene->parts().proxy) << proxied_garments()[k];
        EXPECT_LT(scene->parts().proxy->vertex_count(), 1100);
        EXPECT_GT(scene->garment().vertex_count(), 1800);
    }
}

/// The environment variable has a value for as long as this lives.
class SharedData {
 public:
    explicit SharedData(const std::string& folder) {
        const char* const before = std::getenv(name);
        if (before != nullptr) m_before = before;
        setenv(name, folder.c_str(), 1);
    }
    ~SharedData() { m_before ? setenv(name, m_before->c_str(), 1) : unsetenv(name); }
    SharedData(const SharedData&) = delete;
    SharedData& operator=(const SharedData&) = delete;

 private:
    static constexpr const char* name = "CLOTH_SHARED_DATA";
    std::optional<std::string> m_before;
};

TEST(SceneFactory, RefusesMotionsThatAreNotThereOrBroken) {
    const std::string folder = testing::TempDir() + "training_worlds_shared";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder + "/motions/train");
    const SharedData shared(folder);
    SceneSettings settings;
    settings.garments = {"skirt_1000"};
    const auto message = [&] {
        try {
            const SceneFactory factory(ModelConfig::variant_named("fast"), settings, 1);
        } catch (const std::exception& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(message().find(folder + "/motions/train: has no motion to train on"),
              std::string::npos);
    std::ofstream(folder + "/motions/train/07_02_walk.bvh") << "held out";
    EXPECT_NE(message().find("has no motion to train on"), std::string::npos);
    std::ofstream(folder + "/motions/train/mine.bvh") << "broken";
    EXPECT_NE(message().find(folder + "/motions/train/mine.bvh"), std::string::npos);
    settings.garment_share = 0.0;
    EXPECT_EQ(message(), "") << "sheets need no motion";
    settings.garment_share = 0.5;
    settings.motions = {"01_01"};
    EXPECT_NE(message().find("SceneSettings.motions"), std::string::npos);
}

TEST(TrainingMotions, AFolderThatIsNamedInVainIsSaid) {
    for (const char* folder : {"/no/such/folder", "/proc"}) {
        const SharedData shared(folder);
        testing::internal::CaptureStderr();
        EXPECT_EQ(training_motions(), (std::vector<std::string>{"01_03", "Boxing_Toes"}));
        const std::string said = testing::internal::GetCapturedStderr();
        EXPECT_NE(said.find(std::string("CLOTH_SHARED_DATA is ") + folder), std::string::npos);
    }
}

TEST(ValidationClips, AreThoseOfTheFolderThatIsNamed) {
    const std::string folder = testing::TempDir() + "validation_clips_shared";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder + "/motions/validation");
    const SharedData shared(folder);
    EXPECT_THROW(validation_clips(), LoadError);
    EXPECT_THROW(default_rollout_clips(), LoadError);
    const std::string start = folder + "/motions/validation/";
    const auto add = [&](const std::string& name) { std::ofstream(start + name) << "BVH"; };
    for (const char* name : {"c.bvh", "a.bvh", "b.bvh", "07_02_walk.bvh"}) add(name);
    EXPECT_EQ(validation_clips(),
              (std::vector<std::string>{start + "07_02_walk.bvh", start + "a.bvh"}));
    EXPECT_EQ(default_rollout_clips().size(), 4u);
    add("16_35.bvh");
    EXPECT_EQ(validation_clips(), (std::vector<std::string>{"07_02", "16_35"}));
}

TEST(CarriedAlong, AGarmentMovesWithTheSkinUnderIt) {
    const TriMesh skirt{load_garment_start("skirt_1000").x, load_garment_mesh("skirt_1000").faces};
    const Points skin = Body::load_default().rest();
    const Points moved = skin.rowwise() + Eigen::RowVector3d(0.1, -0.2, 0.3);
    const Points carried = carried_along(skirt.vertices, skin, moved);
    EXPECT_LT((carried.rowwise() - Eigen::RowVector3d(0.1, -0.2, 0.3)).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace cloth::training_worlds_test
