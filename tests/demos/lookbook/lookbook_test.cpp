#include "demos/lookbook/lookbook.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "data/core/paths.h"
#include "data/core/read_file.h"
#include "demos/compare/arguments.h"
#include "demos/lookbook/look.h"

namespace cloth::lookbook_test {

namespace {

LookbookOptions small_book(const std::string& name) {
    LookbookOptions options;
    options.garments = {"tshirt_1000", "skirt_1000"};
    options.bodies = {"default"};
    options.solver = "quasi-newton-3";
    options.frames = 4;
    options.out = ::testing::TempDir() + name;
    std::filesystem::remove_all(options.out);
    return options;
}

const auto quiet = [](int, int, const std::string&) {};

}  // namespace

TEST(Lookbook, ShowsAndMeasuresEachGarmentOnEachBody) {
    const LookbookOptions options = small_book("lookbook");
    const nlohmann::ordered_json rows = make_lookbook(options, quiet);
    ASSERT_EQ(rows.size(), 2u);
    for (size_t k = 0; k < rows.size(); ++k) {
        EXPECT_EQ(rows[k].at("garment"), options.garments[k]);
        EXPECT_EQ(rows[k].at("body"), "default");
        EXPECT_EQ(rows[k].at("frames"), 4);
        EXPECT_EQ(rows[k].at("failed_steps"), 0);
        EXPECT_GE(rows[k].at("stretch_max").get<double>(), rows[k].at("stretch_p99"));
        EXPECT_TRUE(rows[k].at("failure").is_null()) << rows[k].at("failure");
    }
    for (const char* file : {"/lookbook.png", "/default.mp4"})
        EXPECT_GT(std::filesystem::file_size(options.out + file), 10000u) << file;
}

TEST(Lookbook, AGarmentOfSeveralPartsIsDrawnPartByPart) {
    BodySceneSettings settings;
    settings.garment = "tshirt_1000+pants_1000";
    settings.frames = 1;
    const Look look(settings, "quasi-newton-3", 0);
    const Scene scene = look.picture(0);
    ASSERT_EQ(scene.meshes.size(), 3u);  // with the skin
    EXPECT_EQ(scene.meshes[1].faces->rows() + scene.meshes[2].faces->rows(),
              look.scene().garment().face_count());
}

TEST(Lookbook, AGarmentOfAFileIsHeadedByTheFilesName) {
    LookbookOptions options = small_book("headings");
    options.garments = {"skirt_1000"};
    options.frames = 1;
    options.video = false;
    make_lookbook(options, quiet);
    const std::string named = read_file(options.out + "/lookbook.png");
    const std::string folder = options.out + "/a/folder/with/a/long/name";
    std::filesystem::create_directories(folder);
    for (const char* ending : {".obj", ".worn.obj"})
        std::filesystem::copy_file(asset_path("garments") + "/skirt_1000" + ending,
                                   folder + "/skirt_1000" + ending);
    options.garments = {folder + "/skirt_1000.obj"};
    make_lookbook(options, quiet);
    EXPECT_EQ(read_file(options.out + "/lookbook.png"), named);
}

TEST(Lookbook, ALossIsReported) {
    BodySceneSettings settings;
    settings.garment = "tshirt_1000";
    settings.frames = 60;
    Look look(settings, "quasi-newton-1", 0);  // tears it (whole_motion has the same)
    look.settle();
    while (look.frame() < look.frames() && look.failure().empty()) look.step();
    EXPECT_NE(look.failure().find("frame "), std::string::npos);
    EXPECT_EQ(look.measured().at("failure"), look.failure());
}

TEST(Lookbook, WrongNamesAreNamedBeforeAnythingIsComputed) {
    EXPECT_THROW(parse_lookbook_options({"--garments", "tshirt,toga"}), UsageError);
    EXPECT_THROW(parse_lookbook_options({"--bodies", "default,giant"}), UsageError);
    EXPECT_THROW(parse_lookbook_options({"--frames", "-1"}), UsageError);
}

}  // namespace cloth::lookbook_test
