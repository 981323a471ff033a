// Every file of MakeHuman's clothes that is at hand, imported and worn in motion.

#include <gtest/gtest.h>

#include <filesystem>

#include "collision/proximity/metrics.h"
#include "data/core/paths.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/solver_factory.h"
#include "demos/import_garment/import.h"

namespace cloth::makehuman_clothes_test {

TEST(MakeHumanClothes, AreImportedAndWornWithoutAHandWrittenStep) {
    const auto folder = shared_data_path("body_makehuman/clothes");
    if (!folder) GTEST_SKIP() << "no MakeHuman clothes in the shared data folder";
    const std::string out = ::testing::TempDir() + "makehuman_clothes";
    std::filesystem::remove_all(out);
    int worn = 0;
    for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
        if (entry.path().extension() != ".mhclo") continue;
        const ImportResult result = import_file(parse_import_options(
            {entry.path().string(), "--vertices", "1000", "--no-picture", "--out", out}));
        EXPECT_EQ(result.files.size(), 2u) << entry.path();
        for (const std::string& file : result.files) {
            SCOPED_TRACE(file);
            BodySceneSettings settings;
            settings.garment = file;
            settings.motion = "01_03";
            settings.frames = 30;
            settings.limbs = true;
            const BodyScene scene(settings);
            const auto stepper = make_solver("quasi-newton", scene, {{}, 0, nullptr});
            ClothState state = scene.start();
            for (int frame = -scene.lead_in_frames(); frame < scene.frames(); ++frame) {
                const Boundary boundary = scene.frame_boundary(frame);
                ASSERT_TRUE(stepper->step(boundary, scene.frame_time(), state).finite) << frame;
                if (frame < 0) continue;
                ASSERT_EQ(scene.loss(boundary, state.x), "") << frame;
            }
            EXPECT_LT(measure_stretch(scene.garment(), state.x).p99, 1.6);
            ++worn;
        }
    }
    EXPECT_GE(worn, 2);
    std::filesystem::remove_all(out);
}

}  // namespace cloth::makehuman_clothes_test
