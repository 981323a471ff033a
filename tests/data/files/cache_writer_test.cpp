#include "data/files/cache_writer.h"

#include <gtest/gtest.h>

#include <limits>

#include "data/core/read_file.h"
#include "data/files/cache_format.h"
#include "data/files/mesh_io.h"
#include "tests/data/files/file_fixture.h"
#include "tests/data/files/sample_motion.h"
#include "tests/ranges.h"

namespace cloth::cache_writer_test {

using namespace test;

namespace {

const char* const single_files[] = {"a.pc2", "a.mdd", "a.usda"};

class Caches : public FileTest {
 protected:
    /// A cache of five frames, left after three of them.
    std::string interrupted(const std::string& name) const {
        const auto cache = make_cache_writer(path(name), sample_mesh(), {30.0, 5});
        add_frames(*cache, 3);
        return unfinished_cache(path(name));
    }
    void go_on(const std::string& name) const {
        const auto cache =
            make_cache_writer(path(name), sample_mesh(), {30.0, 5}, CacheStart::go_on);
        add_frames(*cache, 5);
        cache->finish();
    }
};

}  // namespace

TEST_F(Caches, OneThatGoesOnEndsAsIfItHadNotBeenInterrupted) {
    for (const std::string name : single_files) {
        write_cache(path(name), 5);
        const std::string whole = read_file(path(name));
        std::filesystem::remove(path(name));
        const std::string unfinished = interrupted(name);
        const auto size = std::filesystem::file_size(unfinished);
        const std::string text = read_file(unfinished);
        // cut within a frame, within the header, before its first byte; and with its end
        for (const size_t left : {size, size - 1, size - 20, size / 3, size_t{5}, size_t{0}}) {
            SCOPED_TRACE(name + ", cut after " + std::to_string(left) + " bytes");
            write(std::filesystem::path(unfinished).filename().string(), text.substr(0, left));
            go_on(name);
            EXPECT_EQ(read_file(path(name)), whole);
            EXPECT_FALSE(std::filesystem::exists(unfinished));
        }
        SCOPED_TRACE(name + ", not begun");
        go_on(name);
        EXPECT_EQ(read_file(path(name)), whole);
    }
}

TEST_F(Caches, OneThatGoesOnOtherwiseIsRefusedAndKept) {
    for (const std::string name : single_files) {
        SCOPED_TRACE(name);
        const std::string unfinished = interrupted(name);
        const std::string before = read_file(unfinished);
        const auto open = [&](int frames) {
            return make_cache_writer(path(name), sample_mesh(), {30.0, frames}, CacheStart::go_on);
        };
        expect_load_error([&] { open(6); }, unfinished + ", header", "it differs");
        const auto cache = open(5);
        cache->add(sample_frame(0));
        expect_load_error([&] { cache->add(sample_frame(0)); }, unfinished + ", frame 1",
                          "it differs");
        EXPECT_EQ(read_file(unfinished), before);
    }
}

TEST_F(Caches, OneThatBeginsAnewForgetsWhatWasThere) {
    for (const std::string name : single_files) {
        SCOPED_TRACE(name);
        interrupted(name);
        write_cache(path(name), 2);
        const std::string again = read_file(path(name));
        std::filesystem::remove(path(name));
        write_cache(path(name), 2);
        EXPECT_EQ(read_file(path(name)), again);
    }
}

TEST_F(Caches, AnUnfinishedOneLeavesTheOldOneAlone) {
    for (const std::string name : single_files) {
        SCOPED_TRACE(name);
        write_cache(path(name), 2);
        const std::string old = read_file(path(name));
        interrupted(name);
        EXPECT_EQ(read_file(path(name)), old);
    }
}

TEST_F(Caches, FramesThatCannotBeRightAreRefused) {
    for (const std::string name : {"a.pc2", "a.mdd", "a.usda", "a"}) {
        SCOPED_TRACE(name);
        const auto cache = make_cache_writer(path(name), sample_mesh(), {30.0, 2});
        EXPECT_THROW(cache->add(Points::Zero(5, 3)), ArgumentError);
        Points x = sample_frame(0);
        for (const double wrong : {std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::infinity(), 1e39}) {
            x(2, 1) = wrong;
            EXPECT_THROW(cache->add(x), ArgumentError);
        }
        EXPECT_EQ(cache->frames(), 0);
        add_frames(*cache, 1);
        EXPECT_THROW(cache->finish(), ArgumentError);
        add_frames(*cache, 2);
        EXPECT_THROW(cache->add(sample_frame(2)), ArgumentError);
        cache->finish();
    }
}

TEST_F(Caches, AFolderThatIsNotThereIsNamed) {
    for (const std::string name : single_files) {
        const std::string file = path("none/" + name);
        expect_load_error([&] { make_cache_writer(file, sample_mesh(), {}); },
                          unfinished_cache(file), "cannot be written");
    }
    write("file", "");
    expect_load_error([&] { make_cache_writer(path("file"), sample_mesh(), {}); }, "file",
                      "cannot be made");
}

TEST_F(Caches, UnknownEndingsAreRefused) {
    EXPECT_EQ(cache_format("out/shirt.usda"), CacheFormat::usda);
    EXPECT_EQ(cache_format("out.d/shirt"), CacheFormat::obj_sequence);
    for (const char* wrong : {"shirt.abc", "shirt.obj", "", "shirt.PC3"})
        EXPECT_THROW(cache_format(wrong), ArgumentError) << wrong;
    EXPECT_EQ(unfinished_cache("out.d/shirt.pc2"), "out.d/shirt.part.pc2");
    EXPECT_EQ(unfinished_cache("shirt.mdd"), "shirt.part.mdd");
}

TEST_F(Caches, SettingsHaveRanges) {
    const auto use = [](const CacheSettings& settings) { settings.check(); };
    expect_range("CacheSettings.rate", &CacheSettings::rate, 1.0, 1000.0, use);
    for (const int wrong : {0, -1, 1000001}) EXPECT_THROW(use({30.0, wrong}), ArgumentError);
    TriMesh empty;
    empty.vertices.resize(0, 3);
    EXPECT_THROW(make_cache_writer(path("a.pc2"), empty, {}), ArgumentError);
}

TEST_F(Caches, AnObjSequenceHasAMeshFileForEachFrame) {
    for (const std::string folder : {"shirt", "skirt/"}) {
        write_cache(path(folder), 3);
        const std::string name = folder.substr(0, 5);
        for (int k = 0; k < 3; ++k) {
            const TriMesh mesh =
                load_mesh(path(name + "/" + name + "_000" + std::to_string(k + 1) + ".obj"));
            EXPECT_EQ(mesh.vertices, sample_frame(k));
            EXPECT_EQ(mesh.faces, sample_mesh().faces);
        }
        EXPECT_FALSE(std::filesystem::exists(path(name + "/" + name + "_0004.obj")));
    }
}

TEST_F(Caches, AnObjSequenceGoesOn) {
    {
        const auto cache = make_cache_writer(path("a"), sample_mesh(), {30.0, 3});
        add_frames(*cache, 2);
    }
    expect_load_error([&] { make_cache_writer(path("a"), sample_mesh(), {}); }, "a_0001.obj",
                      "is there already");
    const auto cache = make_cache_writer(path("a"), sample_mesh(), {30.0, 3}, CacheStart::go_on);
    add_frames(*cache, 1);
    expect_load_error([&] { cache->add(sample_frame(0)); }, "a_0002.obj", "it differs");
    add_frames(*cache, 3);
    cache->finish();
    EXPECT_EQ(load_mesh(path("a/a_0003.obj")).vertices, sample_frame(2));
    const auto files = std::filesystem::directory_iterator(path("a"));
    EXPECT_EQ(std::distance(begin(files), end(files)), 3) << "nothing else is left";
}

// A triangle's text, written by hand as the format's definition has it.
TEST_F(Caches, UsdHasTheTextOfItsDefinition) {
    TriMesh mesh = sample_mesh();
    mesh.vertices.conservativeResize(3, 3);
    mesh.faces.conservativeResize(1, 3);
    const auto cache = make_cache_writer(path("1 shirt.usda"), mesh, {24.0, 2});
    cache->add(mesh.vertices);
    const std::string begun = R"(#usda 1.0
(
    defaultPrim = "_1_shirt"
    endTimeCode = 1
    framesPerSecond = 24
    metersPerUnit = 1
    startTimeCode = 0
    timeCodesPerSecond = 24
    upAxis = "Y"
)

def Mesh "_1_shirt"
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    uniform token subdivisionScheme = "none"
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]
    point3f[] points.timeSamples = {
        0: [(0, 0, 0), (1, 0, 0), (1, 1, 0)],
)";
    EXPECT_EQ(read_file(path("1 shirt.part.usda")), begun + "    }\n}\n")
        << "whole after every frame";
    cache->add(mesh.vertices.array() * 0.1);
    cache->finish();
    EXPECT_EQ(read_file(path("1 shirt.usda")),
              begun +
                  "        1: [(0, 0, 0), (0.100000001, 0, 0), (0.100000001, 0.100000001, "
                  "0)],\n    }\n}\n");
}

}  // namespace cloth::cache_writer_test
