#include "data/files/cache_writer.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "data/core/read_file.h"
#include "data/files/byte_order.h"
#include "data/files/cache_format.h"
#include "data/files/mesh_io.h"
#include "tests/data/files/file_fixture.h"
#include "tests/data/files/sample_motion.h"
#include "tests/ranges.h"

namespace cloth::cache_writer_test {

using namespace test;

namespace {

const char* const single_files[] = {"a.pc2", "a.mdd", "a.usda", "a.glb"};

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

TEST_F(Caches, OneRunAtATimeWritesToOne) {
    std::filesystem::create_directory(path("again"));
    for (const std::string name : {"a.pc2", "a.mdd", "a.usda", "a.glb", "a"}) {
        SCOPED_TRACE(name);
        const std::string written = name == "a" ? path("a") : unfinished_cache(path(name));
        const auto first = make_cache_writer(path(name), sample_mesh(), {30.0, 3});
        add_frames(*first, 2);
        for (const CacheStart start : {CacheStart::anew, CacheStart::go_on})
            expect_load_error(
                [&] {
                    make_cache_writer(path(name), sample_mesh(), {30.0, 2}, start);
                },
                written, "is being written by another run");
        add_frames(*first, 3);
        first->finish();
        write_cache(path("again/" + name), 3);
    }
    for (const std::string name : single_files)
        EXPECT_EQ(read_file(path(name)), read_file(path("again/" + name))) << name;
    EXPECT_EQ(read_file(path("a/a_0003.obj")), read_file(path("again/a/a_0003.obj")));
    write_cache(path("a.pc2"), 1);  // the lock ends with the run
}

TEST_F(Caches, FramesThatCannotBeRightAreRefused) {
    for (const std::string name : {"a.pc2", "a.mdd", "a.usda", "a.glb", "a"}) {
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
    EXPECT_EQ(unfinished_cache("out.d/shirt.glb"), "out.d/shirt.glb.part.pc2");
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

/// The numbers of an accessor of a .glb file, read as the specification says.
std::vector<float> numbers_of(const nlohmann::json& scene, const std::string& binary, int index) {
    const nlohmann::json& accessor = scene["accessors"].at(static_cast<size_t>(index));
    const nlohmann::json& view = scene["bufferViews"].at(accessor["bufferView"].get<size_t>());
    const size_t begin = view["byteOffset"].get<size_t>() + accessor["byteOffset"].get<size_t>();
    const size_t lanes = accessor["type"] == "VEC3" ? 3 : 1;
    std::vector<float> numbers(accessor["count"].get<size_t>() * lanes);
    for (size_t k = 0; k < numbers.size(); ++k)
        numbers[k] = number_at<float>(binary.data() + begin + 4 * k, ByteOrder::little);
    return numbers;
}

TEST_F(Caches, GlbIsItsFirstFrameAndMorphsToTheOthers) {
    const int count = 4;
    write_cache(path("cape.glb"), count);
    const TriMesh first = load_mesh(path("cape.glb"));
    EXPECT_LT((first.vertices - sample_frame(0)).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_EQ(first.faces, sample_mesh().faces);

    const std::string file = read_file(path("cape.glb"));
    const auto word = [&](size_t at) {
        return number_at<std::uint32_t>(file.data() + at, ByteOrder::little);
    };
    ASSERT_EQ(word(8), file.size());
    const size_t text = word(12);
    EXPECT_EQ(text % 4, 0u);
    const auto scene = nlohmann::json::parse(file.substr(20, text));
    const std::string binary = file.substr(28 + text);
    ASSERT_EQ(word(20 + text), binary.size());
    EXPECT_EQ(scene["buffers"][0]["byteLength"], binary.size());
    const auto& primitive = scene["meshes"][0]["primitives"][0];
    ASSERT_EQ(primitive["targets"].size(), size_t{count - 1});
    const Points normals = vertex_normals(sample_frame(0), sample_mesh().faces);
    for (int k = 1; k < count; ++k) {
        const auto& target = primitive["targets"][static_cast<size_t>(k - 1)];
        const Points moved = sample_frame(k) - sample_frame(0);
        const Points turned = vertex_normals(sample_frame(k), sample_mesh().faces) - normals;
        const auto places = numbers_of(scene, binary, target["POSITION"]);
        const auto turns = numbers_of(scene, binary, target["NORMAL"]);
        ASSERT_EQ(places.size(), static_cast<size_t>(moved.size()));
        for (Eigen::Index i = 0; i < moved.size(); ++i) {
            EXPECT_NEAR(places[static_cast<size_t>(i)], moved.data()[i], 1e-6);
            EXPECT_NEAR(turns[static_cast<size_t>(i)], turned.data()[i], 1e-6);
        }
        const auto& accessor = scene["accessors"][target["POSITION"].get<size_t>()];
        for (size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(accessor["max"][c].get<float>(),
                      moved.col(static_cast<Eigen::Index>(c)).cast<float>().maxCoeff());
        }
    }
    const auto& sampler = scene["animations"][0]["samplers"][0];
    const auto times = numbers_of(scene, binary, sampler["input"]);
    const auto weights = numbers_of(scene, binary, sampler["output"]);
    ASSERT_EQ(times.size(), size_t{count});
    ASSERT_EQ(weights.size(), size_t{count * (count - 1)});
    for (size_t k = 0; k < times.size(); ++k) {
        EXPECT_FLOAT_EQ(times[k], static_cast<float>(k) / 30.0f);
        for (size_t target = 1; target < times.size(); ++target)
            EXPECT_EQ(weights[k * (times.size() - 1) + target - 1], k == target ? 1.0f : 0.0f);
    }
    write_cache(path("still.glb"), 1);
    EXPECT_LT((load_mesh(path("still.glb")).vertices - sample_frame(0)).cwiseAbs().maxCoeff(),
              1e-6);
}

TEST_F(Caches, GlbThatWouldBeTooLargeIsRefused) {
    EXPECT_THROW(make_cache_writer(path("a.glb"), sample_mesh(), {30.0, 1001}), ArgumentError);
    TriMesh large = sample_mesh();
    large.vertices = Points::Zero(200000, 3);
    EXPECT_THROW(make_cache_writer(path("a.glb"), large, {30.0, 1000}), ArgumentError);
    EXPECT_FALSE(std::filesystem::exists(path("a.glb.part.pc2"))) << "nothing is begun";
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
