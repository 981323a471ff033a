// What is kept of a run, and when it is made anew.

#include "demos/compare/work_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "data/core/errors.h"
#include "demos/compare/input_files.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::work_folder_test {

using test::FileTest;

using InputFiles = FileTest;

TEST_F(InputFiles, AreToldApartByTheirBytes) {
    const std::string a = write("a", "weights"), b = write("b", "Weights");
    EXPECT_NE(fingerprint(a), fingerprint(b));
    write("b", "weights");
    EXPECT_EQ(fingerprint(a), fingerprint(b));
    write("b", "a");
    EXPECT_EQ(fingerprint(b), "af63dc4c8601ec8c") << "FNV-1a of one letter, as published";
    EXPECT_EQ(fingerprint(""), "");
    EXPECT_THROW(fingerprint(path("none")), LoadError);
    EXPECT_EQ(files_key({}), "");
    EXPECT_EQ(short_key({}), "");
    EXPECT_EQ(files_key({b}), b + ", 1 bytes, af63dc4c8601ec8c");
    const std::string before = short_key({a, b});
    EXPECT_EQ(before.size(), 17u);
    write("b", "b");
    EXPECT_NE(short_key({a, b}), before);
}

TEST_F(InputFiles, OfAGarmentAreItsOwnWithAllThatIsReadWithThem) {
    const std::string skirt = write("skirt.obj", ""), worn = write("skirt.worn.obj", "");
    const std::string buffer = write("cape.bin", "");
    const std::string cape =
        write("cape.gltf", R"({"buffers": [{"uri": "cape.bin"}, {"uri": "data:,"}, {}]})");
    EXPECT_EQ(garment_files(skirt), (std::vector<std::string>{skirt, worn}));
    EXPECT_EQ(garment_files(skirt + "+tshirt+" + cape),
              (std::vector<std::string>{skirt, worn, cape, buffer}));
    EXPECT_TRUE(garment_files("tshirt+pants").empty()) << "the commit tells these apart";
    const std::string walk = write("walk.bvh", "");
    EXPECT_EQ(scene_files(skirt, walk), (std::vector<std::string>{skirt, worn, walk}));
    EXPECT_TRUE(scene_files("tshirt", "01_01").empty());
}

TEST_F(InputFiles, OfASolverAreTheNetworksOfItsName) {
    const std::string small = write("small.safetensors", "");
    write("small_detail.safetensors", "");
    write("elsewhere.safetensors", "");
    const std::string coarse = write("coarse.obj", "");
    const auto files = [&](const std::string& solver) { return solver_files(solver, path("")); };
    EXPECT_TRUE(files("quasi-newton-3").empty());
    const std::vector<std::string> both = files("small+3~" + coarse + "+small_detail");
    ASSERT_EQ(both.size(), 3u);
    EXPECT_EQ(fingerprint(both[0]), fingerprint(small));
    EXPECT_EQ(std::filesystem::path(both[1]).filename(), "small_detail.safetensors");
    EXPECT_EQ(both[2], coarse);
    EXPECT_EQ(solver_files("small", "").size(), 1u) << "the committed ones";
}

class WorkFolder : public FileTest {
 protected:
    void SetUp() override {
        FileTest::SetUp();
        m_options.garment = write("skirt.obj", "v 0 0 0");
        m_options.motion = write("walk.bvh", "HIERARCHY");
        m_options.solvers = {"small", "xpbd-40"};
        std::filesystem::create_directories(path("weights"));
        m_options.weights = path("weights");
        write("weights/small.safetensors", "one");
        m_options.out = path("out");
        prepare_and_fill();
    }

    void prepare_and_fill() {
        prepare_work_folder(m_options);
        for (const char* part : {"fine.traj", "small.traj", "small.json", "xpbd-40.json"})
            write(std::string("out/parts/") + part, "");
    }
    /// Which parts are left, when it is prepared again.
    std::vector<std::string> left() {
        prepare_work_folder(m_options);
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(path("out/parts")))
            if (entry.path().filename() != "settings.json")
                names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

    CompareOptions m_options;
    const std::vector<std::string> m_all = {"fine.traj", "small.json", "small.traj",
                                            "xpbd-40.json"};
};

TEST_F(WorkFolder, PartsAreKeptWhileNothingChanges) {
    EXPECT_EQ(left(), m_all);
    m_options.solvers.push_back("quasi-newton");
    EXPECT_EQ(left(), m_all) << "another solver";
    EXPECT_EQ(work_file(m_options, "small~my/coarse.obj"), path("out/parts/small~my_coarse.obj"));
}

TEST_F(WorkFolder, FilesThatChangedUnderTheSameNameCount) {
    write("skirt.obj", "v 0 0 1");  // as long as before
    EXPECT_TRUE(left().empty());
    prepare_and_fill();
    write("skirt.worn.obj", "v 0 0 1");
    EXPECT_TRUE(left().empty()) << "its worn shape";
    prepare_and_fill();
    write("walk.bvh", "hierarchy");
    EXPECT_TRUE(left().empty()) << "the motion";
}

TEST_F(WorkFolder, AnotherBodyIsAnotherScene) {
    m_options.body = "heavy";
    EXPECT_TRUE(left().empty());
}

TEST_F(WorkFolder, OtherWeightsConcernTheirSolverAlone) {
    write("weights/small.safetensors", "two");
    EXPECT_EQ(left(), (std::vector<std::string>{"fine.traj", "xpbd-40.json"}));
}

TEST_F(WorkFolder, ARecordThatIsDamagedIsNamed) {
    write("out/parts/settings.json", "[");
    test::expect_load_error([&] { prepare_work_folder(m_options); }, "settings.json",
                            "is not a JSON object");
    write("out/parts/settings.json", R"({"garment": "of an older program"})");
    EXPECT_TRUE(left().empty());
}

using OutFolder = FileTest;

TEST_F(OutFolder, ThatCannotBeMadeIsNamedWithARemedy) {
    CompareOptions options;
    options.out = write("file", "") + "/out";
    test::expect_load_error([&] { prepare_work_folder(options); }, options.out,
                            "the folder cannot be made");
}

}  // namespace cloth::work_folder_test
