#include "data/body/skinned_character.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "data/body/welded_character.h"
#include "data/core/mesh.h"
#include "data/core/paths.h"
#include "tests/data/files/file_fixture.h"
#include "tests/data/files/sample_motion.h"
#include "tests/ranges.h"

namespace cloth::skinned_character_test {

using namespace cloth::test;

namespace {

const std::string strip = "glTF2/simple_skin/simple_skin.gltf";

std::string read(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

/// Row of `points` nearest to `p`, and how far it is.
double distance_to_nearest(const Points& points, const Vec3& p) {
    return (points.rowwise() - p.transpose()).rowwise().norm().minCoeff();
}

}  // namespace

TEST(SkinnedCharacter, AStripBendsAboutItsSecondJoint) {
    // Khronos' SimpleSkin: 1 m wide, 2 m high, the upper joint at 1 m turns by 90 degrees until
    // 1 s; its top edge follows that joint alone, its bottom edge the fixed one.
    const SkinnedCharacter character(model_path(strip));
    EXPECT_EQ(character.vertices(0.0).rows(), 10);
    EXPECT_EQ(character.faces()->rows(), 8);
    EXPECT_DOUBLE_EQ(character.duration(), 5.5);
    const Points rest = character.vertices(0.0), bent = character.vertices(1.0);
    for (const Vec3& corner : {Vec3(-0.5, 2, 0), Vec3(0.5, 2, 0), Vec3(0.5, 0, 0)})
        EXPECT_LT(distance_to_nearest(rest, corner), 1e-6);
    for (const Vec3& corner : {Vec3(-1, 0.5, 0), Vec3(-1, 1.5, 0), Vec3(0.5, 0, 0)})
        EXPECT_LT(distance_to_nearest(bent, corner), 1e-6);
    // Halfway in time is halfway in angle: 22.5 degrees key at 0.5 s is 45, so 0.25 s is 22.5.
    const double angle = M_PI / 8.0;
    const Vec3 corner(0.5 * std::cos(angle) - std::sin(angle),
                      1.0 + 0.5 * std::sin(angle) + std::cos(angle), 0.0);
    EXPECT_LT(distance_to_nearest(character.vertices(0.25), corner), 1e-3);
}

TEST(SkinnedCharacter, RigidBonesOfColladaMoveRigidly) {
    const SkinnedCharacter box(model_path("Collada/box_nested_animation.dae"));
    EXPECT_EQ(box.vertices(0.0).rows(), 8);
    EXPECT_NEAR(box.duration(), 1.667, 0.01);
    const Points start = box.vertices(0.0), later = box.vertices(0.8);
    EXPECT_GT((later - start).rowwise().norm().maxCoeff(), 0.1);
    for (const auto& [i, j] : undirected_edges(*box.faces()))
        EXPECT_NEAR((later.row(i) - later.row(j)).norm(), (start.row(i) - start.row(j)).norm(),
                    1e-5);
}

TEST(SkinnedCharacter, ARealCharacterStaysWhole) {
    CharacterSettings settings;
    settings.animation = "Wuson_Walk";
    const SkinnedCharacter bison(model_path("X/Testwuson.X"), settings);
    EXPECT_EQ(bison.vertices(0.0).rows(), 2117);  // 11,196 in the file: split along seams
    EXPECT_EQ(bison.rig().joints.size(), 37u);
    const Points start = bison.vertices(0.0);
    const auto edges = undirected_edges(*bison.faces());
    for (double time = 0.0; time < bison.duration(); time += 0.4) {
        const Points x = bison.vertices(time);
        ASSERT_TRUE(x.allFinite());
        int torn = 0;
        for (const auto& [i, j] : edges) {
            const double ratio =
                (x.row(i) - x.row(j)).norm() / (start.row(i) - start.row(j)).norm();
            torn += ratio > 2.0 || ratio < 0.3;
        }
        EXPECT_LT(torn, 0.02 * static_cast<double>(edges.size())) << time;
    }
    const Obstacle obstacle = bison.obstacle(0.4, 0.5);
    EXPECT_EQ(obstacle.faces, bison.faces());
    EXPECT_EQ(obstacle.x0, bison.vertices(0.4));
    EXPECT_EQ(obstacle.x1, bison.vertices(0.5));
}

TEST(SkinnedCharacter, TheRestPoseIsThatOfTheFileNotOfTheAnimation) {
    const SkinnedCharacter character(model_path(strip));
    const Points rest = character.rest_vertices();
    for (const Vec3& corner : {Vec3(-0.5, 2, 0), Vec3(0.5, 2, 0), Vec3(0.5, 0, 0)})
        EXPECT_LT(distance_to_nearest(rest, corner), 1e-6);
    CharacterSettings settings;
    settings.animation = "Wuson_Walk";
    const SkinnedCharacter bison(model_path("X/Testwuson.X"), settings);
    settings.animation = "Wuson_Bind";
    const SkinnedCharacter bound(model_path("X/Testwuson.X"), settings);
    EXPECT_LT((bison.rest_vertices() - bound.vertices(0.0)).rowwise().norm().maxCoeff(), 1e-3);
    EXPECT_GT((bison.rest_vertices() - bison.vertices(0.0)).rowwise().norm().maxCoeff(), 0.1);
}

TEST(SkinnedCharacter, ScaleTurnsFileUnitsIntoMetres) {
    CharacterSettings settings;
    settings.scale = 0.01;
    const Points whole = SkinnedCharacter(model_path(strip)).vertices(0.7);
    const Points small = SkinnedCharacter(model_path(strip), settings).vertices(0.7);
    EXPECT_LT((small - 0.01 * whole).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SkinnedCharacter, SettingsOutOfRangeAreRefused) {
    using S = CharacterSettings;
    const auto use = [](const S& settings) { SkinnedCharacter(model_path(strip), settings); };
    test::expect_range("CharacterSettings.scale", &S::scale, 1e-6, 1e6, use);
    test::expect_range("CharacterSettings.friction", &S::friction, 0.0, 1.5, use);
}

using CharacterFile = FileTest;

TEST_F(CharacterFile, BrokenFilesAreRefused) {
    const std::string text = read(model_path(strip));
    const auto error_of = [&](const std::string& name, const std::string& content,
                              const std::string& message) {
        const std::string file = write(name, content);
        expect_load_error([&] { SkinnedCharacter character(file); }, file, message);
    };
    error_of("empty.gltf", "", "cannot be read");
    error_of("truncated.gltf", text.substr(0, text.size() / 2), "cannot be read");
    expect_load_error([&] { SkinnedCharacter character(path("none.gltf")); }, "none.gltf",
                      "no such file");
}

TEST_F(CharacterFile, WhatIsMissingIsNamed) {
    CharacterSettings settings;
    settings.animation = "Wuson_Fly";
    const std::string bison = model_path("X/Testwuson.X");
    expect_load_error([&] { SkinnedCharacter character(bison, settings); }, bison,
                      "give one of 'Wuson_Run' 'Wuson_Walk' 'Wuson_Bind'");
    settings = {};
    settings.mesh_name = "Tail";
    expect_load_error([&] { SkinnedCharacter character(bison, settings); }, bison,
                      "there is no such mesh with triangles. Remedy: give one of '");
    settings = {};
    settings.animation = "swim";
    const std::string duck = model_path("Collada/duck.dae");
    expect_load_error([&] { SkinnedCharacter character(duck, settings); }, duck,
                      "leave the name out: the file has no animation");
}

TEST(SkinnedCharacter, WithoutAnAnimationItStandsInThePoseOfTheFile) {
    const SkinnedCharacter duck(model_path("Collada/duck.dae"));  // it has no skeleton, either
    EXPECT_EQ(duck.duration(), 0.0);
    EXPECT_EQ(duck.frame_count(1.0 / 30.0), 1);
    EXPECT_EQ(duck.vertices(1.0), duck.rest_vertices());
    for (const SkinMatrix& matrix : duck.skin_matrices(1.0)) {
        EXPECT_LT((matrix.leftCols<3>() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
        EXPECT_LT(matrix.col(3).norm(), 1e-6);
    }
}

// A cache of two frames is such a file.
TEST_F(CharacterFile, AnAnimationOfMorphTargetsAloneMovesNothingAndIsSaid) {
    write_cache(path("morphs.glb"), 2, 1.0);
    const WeldedCharacter character(path("morphs.glb"), {}, 1e-4);
    EXPECT_TRUE(character.has_unread_morphs());
    EXPECT_EQ(character.duration(), 0.0) << "it would be announced";
    EXPECT_EQ(character.vertices(1.0), character.rest().vertices);
    EXPECT_FALSE(WeldedCharacter(model_path("X/BCN_Epileptic.X"), {}, 1e-4).has_unread_morphs());
}

TEST_F(CharacterFile, AByteOrderMarkOfAnObjFileCostsNoVertex) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const SkinnedCharacter character(write("marked.obj", "\xEF\xBB\xBF" + text));
    EXPECT_EQ(character.faces()->rows(), 1);
    EXPECT_EQ(character.vertices(0.0).rows(), 3);
}

TEST(WeldedCharacter, IsTheSkinWithoutItsSeamsInEveryPose) {
    const std::string file = model_path("X/BCN_Epileptic.X");
    const SkinnedCharacter split(file);
    const WeldedCharacter skin(file, {}, 1e-4);
    EXPECT_LT(skin.rest().vertices.rows(), split.rest_vertices().rows());
    EXPECT_EQ(*skin.faces(), skin.rest().faces);
    EXPECT_LT(skin.faces()->maxCoeff(), skin.rest().vertices.rows());
    EXPECT_DOUBLE_EQ(skin.duration(), split.duration());
    EXPECT_NEAR(skin.height(), 1.8, 0.3);
    for (const double time : {0.0, 0.2}) {
        const Points welded = skin.vertices(time), all = split.vertices(time);
        for (Eigen::Index i = 0; i < welded.rows(); i += 50)
            EXPECT_EQ(distance_to_nearest(all, welded.row(i)), 0.0);
        for (Eigen::Index i = 0; i < all.rows(); i += 50)
            EXPECT_LT(distance_to_nearest(welded, all.row(i)), 1e-3);
    }
}

}  // namespace cloth::skinned_character_test
