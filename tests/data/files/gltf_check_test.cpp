#include <functional>
#include <limits>

#include "data/body/skinned_character.h"
#include "tests/data/files/file_fixture.h"
#include "tests/data/files/gltf_file.h"

namespace cloth::gltf_check_test {

using namespace test;

namespace {

// Accessors of the strip, see GltfFile.
constexpr size_t faces = 0, joints = 2, weights = 3;

class BrokenGltf : public FileTest {
 protected:
    void expect_refusal(const std::function<void(GltfFile&)>& spoil,
                        const std::string& message) const {
        GltfFile file;
        spoil(file);
        file.save(path("a.gltf"));
        expect_load_error([&] { SkinnedCharacter character(path("a.gltf")); }, path("a.gltf"),
                          message);
    }
};

}  // namespace

TEST_F(BrokenGltf, ASoundOneIsRead) {
    GltfFile file;
    file.set<std::uint16_t>(joints, 0, 9);  // of no joint, and of no weight
    file.set<float>(weights, 0, 0.0f);
    file.set<std::uint16_t>(joints, 1, 0);
    file.set<float>(weights, 1, 1.0f);
    file.save(path("a.gltf"));
    EXPECT_EQ(SkinnedCharacter(path("a.gltf")).vertices(0.0).rows(), 10);
}

TEST_F(BrokenGltf, FacesOfNoVertexAreRefused) {
    expect_refusal([](GltfFile& file) { file.set<std::uint16_t>(faces, 4, 10); },
                   "mesh 0, primitive 0, faces: one refers to a vertex that does not exist, no. 10 "
                   "of 10");
    expect_refusal([](GltfFile& file) { file.json["accessors"][faces]["componentType"] = 5126; },
                   "its numbers are no whole numbers");
}

TEST_F(BrokenGltf, SkinsOfAnotherKindAreRefused) {
    expect_refusal([](GltfFile& file) { file.json["skins"][0]["joints"] = {1}; },
                   "its skin weight is for joint no. 1, and the skin has 1");
    expect_refusal([](GltfFile& file) { file.json["accessors"][weights]["type"] = "VEC2"; },
                   "WEIGHTS_0: it is not of the type VEC4");
    expect_refusal([](GltfFile& file) { file.json["accessors"][weights]["componentType"] = 5121; },
                   "WEIGHTS_0: its numbers are neither floats nor normalised");
    expect_refusal([](GltfFile& file) { file.json["accessors"][joints]["count"] = 9; },
                   "it has joints or weights for another number of vertices");
    for (const float number :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
        expect_refusal([&](GltfFile& file) { file.set(weights, 4 * 3, number); },
                       "vertex 3: its skin weight is not finite");
}

TEST_F(BrokenGltf, ChannelsThatMoveNothingAreRefused) {
    const auto channel = [](GltfFile& file) -> nlohmann::json& {
        return file.json["animations"][0]["channels"][0];
    };
    const auto sampler = [](GltfFile& file) -> nlohmann::json& {
        return file.json["animations"][0]["samplers"][0];
    };
    const std::string place = "animation 0, channel 0: ";
    expect_refusal([&](GltfFile& file) { channel(file)["target"].erase("node"); },
                   place + "its node is missing");
    expect_refusal([&](GltfFile& file) { channel(file)["target"]["node"] = 77; },
                   place + "it refers to a node that is not there");
    expect_refusal([&](GltfFile& file) { channel(file)["sampler"] = 7; },
                   place + "it refers to a sampler that is not there");
    expect_refusal([&](GltfFile& file) { sampler(file).erase("input"); },
                   place + "its input is missing");
    expect_refusal([&](GltfFile& file) { sampler(file)["output"] = 70; },
                   place + "its output is not there");
}

}  // namespace cloth::gltf_check_test
