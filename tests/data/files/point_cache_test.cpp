#include <gtest/gtest.h>

#include <limits>

#include "data/core/read_file.h"
#include "data/files/cache_format.h"
#include "data/files/point_cache_reader.h"
#include "tests/data/files/file_fixture.h"
#include "tests/data/files/sample_motion.h"

namespace cloth::point_cache_test {

using namespace test;

namespace {

class PointCache : public FileTest {
 protected:
    /// A triangle at one place, in one frame.
    std::string write_triangle(const std::string& name) const {
        TriMesh mesh = sample_mesh();
        mesh.vertices.conservativeResize(1, 3);
        const auto cache = make_cache_writer(path(name), mesh, {25.0, 2});
        cache->add(Points::Constant(1, 3, 1.0));
        cache->add(Points::Constant(1, 3, -2.0));
        cache->finish();
        return read_file(path(name));
    }
};

std::string bytes(std::initializer_list<int> values) {
    std::string text;
    for (const int value : values) text += static_cast<char>(value);
    return text;
}

}  // namespace

// 1 is 3f800000 and -2 is c0000000, in IEEE 754.
TEST_F(PointCache, Pc2HasTheBytesOfItsDefinition) {
    EXPECT_EQ(
        write_triangle("a.pc2"),
        bytes({'P', 'O', 'I',  'N',  'T', 'C', 'A',  'C',  'H', 'E', '2',  0,
               1,   0,   0,    0,     // version
               1,   0,   0,    0,     // vertices
               0,   0,   0,    0,     // start frame 0
               0,   0,   0x80, 0x3f,  // one sample for each frame
               2,   0,   0,    0,     // samples
               0,   0,   0x80, 0x3f, 0,   0,   0x80, 0x3f, 0,   0,   0x80, 0x3f,     // 1, 1, 1
               0,   0,   0,    0xc0, 0,   0,   0,    0xc0, 0,   0,   0,    0xc0}));  // -2, -2, -2
}

// 1/25 is 3d23d70a.
TEST_F(PointCache, MddHasTheBytesOfItsDefinition) {
    EXPECT_EQ(write_triangle("a.mdd"),
              bytes({0,    0,    0,    2,     // frames
                     0,    0,    0,    1,     // vertices
                     0,    0,    0,    0,     // time 0
                     0x3d, 0x23, 0xd7, 0x0a,  // time 0.04 s
                     0x3f, 0x80, 0,    0,    0x3f, 0x80, 0, 0, 0x3f, 0x80, 0, 0,
                     0xc0, 0,    0,    0,    0xc0, 0,    0, 0, 0xc0, 0,    0, 0}));
}

TEST_F(PointCache, WhatWasWrittenIsRead) {
    for (const char* name : {"a.pc2", "a.mdd"}) {
        SCOPED_TRACE(name);
        write_cache(path(name), 5);
        PointCacheReader cache(path(name));
        EXPECT_EQ(cache.vertices(), 4);
        EXPECT_EQ(cache.frames(), 5);
        EXPECT_EQ(cache.shortfall(), "");
        for (const int k : {4, 0, 2}) EXPECT_EQ(cache.frame(k), sample_frame(k));
        EXPECT_FALSE(std::filesystem::exists(unfinished_cache(path(name))));
    }
    const std::vector<double> times = PointCacheReader(path("a.mdd")).times();
    ASSERT_EQ(times.size(), 5u);
    EXPECT_NEAR(times[4], 4.0 / 30.0, 1e-7);
}

TEST_F(PointCache, AnInterruptedOneIsReadUpToItsLastWholeFrame) {
    for (const char* name : {"a.pc2", "a.mdd"}) {
        SCOPED_TRACE(name);
        const std::string unfinished = unfinished_cache(path(name));
        {
            const auto cache = make_cache_writer(path(name), sample_mesh(), {30.0, 5});
            add_frames(*cache, 3);
            EXPECT_EQ(PointCacheReader(unfinished).frames(), 3) << "while it is written";
        }
        EXPECT_FALSE(std::filesystem::exists(path(name)));
        std::filesystem::resize_file(unfinished, std::filesystem::file_size(unfinished) - 1);
        PointCacheReader cache(unfinished);
        EXPECT_EQ(cache.frames(), 2);
        EXPECT_EQ(cache.shortfall(), "2 of 5 frames are there");
        EXPECT_EQ(cache.frame(1), sample_frame(1));
        EXPECT_THROW(cache.frame(2), ArgumentError);
    }
}

TEST_F(PointCache, OneOfAnotherMeshIsRefused) {
    write_cache(path("a.pc2"), 1);
    const PointCacheReader cache(path("a.pc2"));
    cache.check_vertices(4);
    expect_load_error([&] { cache.check_vertices(5); }, "a.pc2", "it has 4 vertices, the mesh 5");
}

TEST_F(PointCache, DamagedHeadersAreNamed) {
    write_cache(path("a.pc2"), 2);
    write_cache(path("a.mdd"), 2);
    const std::string pc2 = read_file(path("a.pc2")), mdd = read_file(path("a.mdd"));
    const auto expect = [&](const std::string& name, std::string text, size_t at,
                            const std::string& instead, const std::string& problem) {
        const std::string file = write(name, text.replace(at, instead.size(), instead));
        expect_load_error([&] { PointCacheReader{file}; }, file, problem);
    };
    expect("b.pc2", pc2, 0, "pointcache2", "does not begin with POINTCACHE2");
    expect("b.pc2", mdd, 0, "", "does not begin with POINTCACHE2");
    expect("b.pc2", pc2, 12, bytes({2}), "its version is 2, not 1");
    expect("b.pc2", pc2, 16, bytes({0, 0, 0, 0x7f}), "no whole frame of 2130706432 vertices");
    expect("b.pc2", pc2, 16, bytes({0, 0, 0, 0x80}), "frames of -2147483648 vertices");
    expect("b.pc2", pc2, 28, bytes({0}), "it says 0 frames");
    expect("b.mdd", mdd, 0, bytes({0x7f}), "too short for the times of 2130706434 frames");
    expect("b.mdd", mdd, 0, bytes({0x80}), "it says -2147483646 frames");
    expect("b.mdd", mdd, 4, bytes({0x7f}), "no whole frame");
    expect("b.mdd", mdd, 8, bytes({0x7f, 0xc0}), "its time is not finite");
    expect("b.pc2", pc2.substr(0, 31), 0, "", "the file ends too early");
    expect("b.mdd", mdd.substr(0, 7), 0, "", "the file ends too early");
    expect("b.pc2", pc2.substr(0, 79), 0, "", "no whole frame of 4 vertices");
}

TEST_F(PointCache, APlaceThatIsNotFiniteIsNamed) {
    write_cache(path("a.pc2"), 2);
    std::string text = read_file(path("a.pc2"));
    text.replace(32 + 48 + 12 + 2, 2, bytes({0xc0, 0x7f}));  // NaN: vertex 1 of frame 1
    PointCacheReader cache(write("b.pc2", text));
    EXPECT_EQ(cache.frame(0), sample_frame(0));
    expect_load_error([&] { cache.frame(1); }, "b.pc2, frame 1, vertex 1", "is not finite");
}

TEST_F(PointCache, AWrongFileIsNamed) {
    expect_load_error([&] { PointCacheReader{path("none.pc2")}; }, "none.pc2", "cannot be opened");
    std::filesystem::create_directories(path("folder.mdd"));
    expect_load_error([&] { PointCacheReader{path("folder.mdd")}; }, "folder.mdd", "is a folder");
    write("a.usda", "#usda 1.0");
    EXPECT_THROW(PointCacheReader{path("a.usda")}, ArgumentError);
}

}  // namespace cloth::point_cache_test
