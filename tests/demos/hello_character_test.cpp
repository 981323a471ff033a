// The program hello_character on files that are made here.
#include <sys/wait.h>

#include <cstdio>

#include "data/body/body.h"
#include "data/body/welded_character.h"
#include "data/core/paths.h"
#include "data/core/read_file.h"
#include "data/files/cache_writer.h"
#include "data/files/mesh_io.h"
#include "tests/data/files/file_fixture.h"
#include "tests/data/files/gltf_file.h"

namespace cloth::hello_character_test {

namespace {

class HelloCharacter : public test::FileTest {
 protected:
    const std::string person = model_path("X/BCN_Epileptic.X");
    const std::string cape = asset_path("garments/cape.obj");

    /// What it prints.
    /// @param expected  its exit status
    static std::string run(const std::string& options, int expected) {
        std::string text;
        FILE* const pipe = popen((HELLO_CHARACTER " " + options + " 2>&1").c_str(), "r");
        if (!pipe) return "it cannot be run";
        char buffer[4096];
        while (const size_t n = fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
        EXPECT_EQ(WEXITSTATUS(pclose(pipe)), expected) << text;
        return text;
    }
};

}  // namespace

TEST_F(HelloCharacter, WritesGarmentAndCharacterOfTheSameTime) {
    // Steps of 1/30 s: the third one ends at 0.1 s, of which the first pose is held for 0.02 s.
    run("--character " + person + " --garment " + cape +
            " --pin 0.39 1 --solver quasi-newton --settle 0.02 --seconds 0.05 --out " + path(""),
        0);
    const WeldedCharacter skin(person, {}, 1e-4);
    const Points written = load_mesh(path("character.obj"), "", FacesWithoutArea::keep).vertices;
    const Points end = skin.vertices(3 * (1.0 / 30.0) - 0.02);
    ASSERT_EQ(written.rows(), end.rows());
    EXPECT_LT((written - end).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_GT((written - skin.vertices(0.05)).cwiseAbs().maxCoeff(), 1e-4)
        << "the end that was asked for is another time";
}

TEST_F(HelloCharacter, AnEndlessAnimationIsRefused) {
    test::GltfFile strip;
    constexpr size_t times = 5, last = 11;
    strip.set<float>(times, last, 1e30f);
    strip.save(path("strip.gltf"));
    const std::string text = run("--character " + path("strip.gltf") + " --garment " + cape, 2);
    EXPECT_NE(text.find("its animation is longer than an hour, by the time of its last key. "
                        "Remedy: give --seconds"),
              std::string::npos)
        << text;
}

TEST_F(HelloCharacter, ItsOwnInputIsNotOverwritten) {
    std::filesystem::create_directory(path("out"));
    std::filesystem::create_symlink(path("out"), path("link"));
    save_obj(path("out/garment.obj"), load_mesh(cape));
    save_obj(path("out/character.obj"), Body::load_default().rest_mesh());
    const std::string garment = read_file(path("out/garment.obj"));
    for (const auto& [options, file] : std::vector<std::pair<std::string, std::string>>{
             {"--character " + person + " --garment " + path("out/garment.obj"), "garment.obj"},
             {"--character " + path("out/character.obj") + " --garment " + cape,
              "character.obj"}}) {
        const std::string text = run(options + " --out " + path("link"), 2);
        EXPECT_NE(text.find(path("out/" + file) + " would be overwritten. Remedy: "),
                  std::string::npos)
            << text;
        EXPECT_EQ(text.find("character  "), std::string::npos) << "nothing was computed";
    }
    EXPECT_EQ(read_file(path("out/garment.obj")), garment);
}

TEST_F(HelloCharacter, ACharacterThatIsInsideOutIsRefused) {
    TriMesh skin = Body::load_default().rest_mesh();
    skin.faces.col(1).swap(skin.faces.col(2));
    save_obj(path("statue.obj"), skin);
    const std::string text = run("--character " + path("statue.obj") + " --garment " +
                                     asset_path("garments/tshirt_1000.obj"),
                                 2);
    EXPECT_NE(text.find("statue.obj: it is inside out"), std::string::npos) << text;
}

TEST_F(HelloCharacter, AnAnimationOfMorphTargetsIsNotAnnounced) {
    const TriMesh skin = Body::load_default().rest_mesh();
    const auto cache = make_cache_writer(path("morphs.glb"), skin, {1.0, 2});
    for (const double up : {0.0, 0.5}) {
        Points x = skin.vertices;
        x.col(1).array() += up;
        cache->add(x);
    }
    cache->finish();
    const std::string text =
        run("--character " + path("morphs.glb") + " --garment " +
                asset_path("garments/tshirt_1000.obj") + " --settle 0 --seconds 0.03",
            0);
    EXPECT_NE(text.find("no animation: it stands"), std::string::npos) << text;
    EXPECT_NE(text.find("morphs.glb: its animation changes morph targets"), std::string::npos)
        << text;
}

}  // namespace cloth::hello_character_test
