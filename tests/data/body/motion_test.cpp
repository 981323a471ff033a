#include "data/body/motion.h"

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdlib>

#include "data/core/paths.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::motion_test {

using namespace cloth::test;
using Eigen::Quaterniond;

namespace {

constexpr double degree = M_PI / 180.0;

// A figure of 1.6 m: root, one joint half way up, an end site at the top.
const std::string hierarchy =
    "HIERARCHY\n"                                                                 // line 1
    "ROOT Hips\n"                                                                 // line 2
    "{\n"                                                                         // line 3
    "  OFFSET 0 0 0\n"                                                            // line 4
    "  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"  // line 5
    "  JOINT Spine\n"                                                             // line 6
    "  {\n"                                                                       // line 7
    "    OFFSET 0 0.8 0\n"                                                        // line 8
    "    CHANNELS 3 Zrotation Xrotation Yrotation\n"                              // line 9
    "    End Site\n"                                                              // line 10
    "    {\n"                                                                     // line 11
    "      OFFSET 0 0.8 0\n"                                                      // line 12
    "    }\n"                                                                     // line 13
    "  }\n"                                                                       // line 14
    "}\n";                                                                        // line 15

std::string with_frames(const std::string& rows, int count) {
    return hierarchy + "MOTION\nFrames: " + std::to_string(count) + "\nFrame Time: 0.1\n" + rows;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
}

Quaterniond turn(double degrees, const Vec3& axis) {
    return Quaterniond(Eigen::AngleAxisd(degrees * degree, axis));
}

double distance_in_degrees(const Quaterniond& a, const Quaterniond& b) {
    return a.angularDistance(b) / degree;
}

}  // namespace

using MotionFile = FileTest;

TEST_F(MotionFile, ChannelsApplyInTheOrderOfTheFile) {
    const Motion motion = load_bvh(write("a.bvh", with_frames("1 2 3 10 20 30 40 50 60\n", 1)));
    ASSERT_EQ(motion.frame_count(), 1);
    EXPECT_EQ(motion.name, "a");
    EXPECT_DOUBLE_EQ(motion.frame_time, 0.1);
    EXPECT_EQ(motion.skeleton.names, (std::vector<std::string>{"Hips", "Spine"}));
    EXPECT_EQ(motion.skeleton.parents, (std::vector<int>{-1, 0}));
    const MotionFrame& frame = motion.frames[0];
    EXPECT_TRUE(frame.root_position.isApprox(Vec3(1, 2, 3)));
    const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
    EXPECT_LT(distance_in_degrees(frame.rotations[0], turn(10, z) * turn(20, y) * turn(30, x)),
              1e-6);
    EXPECT_LT(distance_in_degrees(frame.rotations[1], turn(40, z) * turn(50, x) * turn(60, y)),
              1e-6);
}

TEST_F(MotionFile, ForwardKinematicsPutsAChildBesideItsTurnedParent) {
    const Motion motion = load_bvh(write("a.bvh", with_frames("1 2 3 90 0 0 0 0 0\n", 1)));
    const Points joints = joint_positions(motion.skeleton, motion.frames[0]);
    EXPECT_TRUE(Vec3(joints.row(1)).isApprox(Vec3(1.0 - 0.8, 2, 3)));
}

TEST_F(MotionFile, ResamplingKeepsKeysAndTurnsHalfwayBetweenThem) {
    const Motion motion =
        load_bvh(write("a.bvh", with_frames("0 0 0 0 0 0 0 0 0\n0 2 0 80 0 0 0 0 0\n", 2)));
    const Motion finer = resample(motion, 20.0);
    ASSERT_EQ(finer.frame_count(), 3);
    EXPECT_DOUBLE_EQ(finer.duration(), motion.duration());
    EXPECT_LT(distance_in_degrees(finer.frames[1].rotations[0], turn(40, Vec3::UnitZ())), 1e-6);
    EXPECT_NEAR(finer.frames[1].root_position.y(), 1.0, 1e-12);
    EXPECT_LT(distance_in_degrees(finer.frames[2].rotations[0], motion.frames[1].rotations[0]),
              1e-6);
}

TEST_F(MotionFile, UnitsAreToldByTheHeightOfTheFigure) {
    for (double unit : {1.0, 0.056444, 0.01, 0.0254, 0.001}) {
        const std::string length = std::to_string(0.8 / unit);
        std::string text = with_frames("0 0 0 0 0 0 0 0 0\n", 1);
        text = replaced(replaced(text, "0 0.8 0", "0 " + length + " 0"), "0 0.8 0",
                        "0 " + length + " 0");
        const Motion motion = load_bvh(write("a.bvh", text));
        EXPECT_NEAR(motion.skeleton.offsets(1, 1), 0.8, 1e-3) << unit;
    }
    BvhSettings settings;
    settings.scale = 2.0;
    const Motion given = load_bvh(write("a.bvh", with_frames("0 1 0 0 0 0 0 0 0\n", 1)), settings);
    EXPECT_DOUBLE_EQ(given.skeleton.offsets(1, 1), 1.6);
    EXPECT_DOUBLE_EQ(given.frames[0].root_position.y(), 2.0);
}

TEST_F(MotionFile, ACalibrationPoseIsDroppedUnlessToldOtherwise) {
    const std::string file = write("a.bvh", with_frames("0 0 0 0 0 0 0 0 0\n"
                                                        "0 0 0 0 0 0 90 0 0\n"
                                                        "0 0 0 0 0 0 91 0 0\n",
                                                        3));
    // Half of this figure's joints move: not enough of them rest at zero in later frames.
    EXPECT_EQ(load_bvh(file).frame_count(), 2);
    EXPECT_EQ(load_bvh(file, {0.0, FirstFrame::keep}).frame_count(), 3);
    const std::string smooth = write("b.bvh", with_frames("0 0 0 0 0 0 0 0 0\n"
                                                          "0 0 0 0 0 0 9 0 0\n"
                                                          "0 0 0 0 0 0 18 0 0\n",
                                                          3));
    EXPECT_EQ(load_bvh(smooth).frame_count(), 3);
    EXPECT_EQ(load_bvh(smooth, {0.0, FirstFrame::drop}).frame_count(), 2);
}

TEST_F(MotionFile, BrokenFilesNameLineAndRemedy) {
    const std::string row = "0 0 0 0 0 0 0 0 0\n";
    const std::string whole = with_frames(row + row, 2);
    const std::pair<std::string, std::string> broken[] = {
        {"", "the file is empty"},
        {"solid cube\n", "line 1: the file does not begin with HIERARCHY"},
        {whole.substr(0, whole.find("JOINT")), "line 6: the file ends where"},
        {whole.substr(0, whole.find("Frame Time")), "the file ends where 'Frame Time: s'"},
        {with_frames(row, 2), "line 19: the file ends after 1 of 2 frames"},
        {with_frames(row + row + row + "\n" + row, 2), "line 23: the file has 4 rows for 2 frames"},
        {with_frames(row + "0 0 0 0 nan 0 0 0 0\n", 2), "line 20: 'nan' is not a finite number"},
        {with_frames(row + "0 0 0 0 1e999 0 0 0 0\n", 2), "line 20: '1e999' is not a finite"},
        {with_frames("0 0 0 0 0 0 0 0\n", 1), "line 19: the row has 8 values for 9 channels"},
        {with_frames("0 0 0 0 0 0 0 0 0 0\n", 1), "line 19: the row has 10 values for 9"},
        {with_frames("", 0), "line 17: the motion has no frames"},
        {with_frames("", -3), "line 17: the number of frames, '-3', is out of range"},
        {with_frames(row, 2000000000), "line 17: the number of frames, '2000000000', is out of"},
        {replaced(whole, "Frames: 2", "Frames: 1.5"), "the number of frames, '1.5', is out of"},
        {with_frames(row + "0 1e300 0 0 0 0 0 0 0\n", 2), "line 20: the root is more than 1,000"},
        {with_frames("0 -2e6 0 0 0 0 0 0 0\n", 1), "line 19: the root is more than 1,000 km"},
        {replaced(whole, "OFFSET 0 0.8 0", "OFFSET 0 1e300 0"), "line 8: the OFFSET is out of"},
        {replaced(whole, "CHANNELS 3", "CHANNELS 4"), "line 9: CHANNELS announces another number"},
        {replaced(whole, "Xrotation Yrotation\n", "Xrotation Wrotation\n"),
         "line 9: unknown channel 'Wrotation'"},
        {replaced(whole, "JOINT Spine", "JOINT Hips"), "line 6: a second joint is called 'Hips'"},
        {replaced(whole, "JOINT Spine", "BONE Spine"), "line 6: unexpected 'BONE'"},
        {replaced(whole, "OFFSET 0 0.8 0", "OFFSET 0 0.8"), "line 8: OFFSET needs three numbers"},
        {replaced(whole, "Frame Time: 0.1", "Frame Time: 0"), "line 18: the frame time is not"},
        {replaced(whole, "Frame Time: 0.1", "Frame Time: 1e9"), "line 18: the frame time is above"},
        {replaced(whole, "JOINT Spine", std::string("BO\0E", 4)), "line 6: unexpected 'BO?E'"},
    };
    for (const auto& [text, message] : broken) {
        const std::string file = write("broken.bvh", text);
        expect_load_error([&] { load_bvh(file); }, file, message);
    }
    expect_load_error([&] { load_bvh(path("none.bvh")); }, "none.bvh", "cannot be opened");
    expect_load_error([&] { load_bvh(path("")); }, path(""), "is a folder");
}

// Boxing_Toes has one, too.
TEST_F(MotionFile, OneRowTooManyIsLeftAlone) {
    const std::string row = "0 0 0 0 0 0 0 0 0\n";
    EXPECT_EQ(load_bvh(write("a.bvh", with_frames(row + row + row, 2))).frame_count(), 2);
}

TEST_F(MotionFile, AByteOrderMarkIsNoPartOfIt) {
    const std::string text = with_frames("1 2 3 10 20 30 40 50 60\n", 1);
    EXPECT_EQ(load_bvh(write("a.bvh", "\xEF\xBB\xBF" + text)).skeleton.names,
              load_bvh(write("b.bvh", text)).skeleton.names);
}

TEST(Motions, AgreeWithAssimp) {
    for (const std::string name : {"01_01", "Boxing_Toes"}) {
        const std::string file = model_path("BVH/" + name + ".bvh");
        const Motion motion = load_bvh(file, {1.0, FirstFrame::keep});
        Assimp::Importer importer;
        const aiScene* scene = importer.ReadFile(file, 0);
        ASSERT_TRUE(scene != nullptr && scene->mNumAnimations == 1);
        const aiAnimation& animation = *scene->mAnimations[0];
        int compared = 0;
        for (unsigned c = 0; c < animation.mNumChannels; ++c) {
            const aiNodeAnim& channel = *animation.mChannels[c];
            const auto joint = motion.skeleton.find(channel.mNodeName.C_Str());
            ASSERT_TRUE(joint) << channel.mNodeName.C_Str();
            ASSERT_EQ(static_cast<int>(channel.mNumRotationKeys), motion.frame_count());
            for (int frame : {0, 1, 500, motion.frame_count() - 1}) {
                const aiQuaternion& q = channel.mRotationKeys[frame].mValue;
                EXPECT_LT(distance_in_degrees(motion.frames[frame].rotations[*joint],
                                              Quaterniond(q.w, q.x, q.y, q.z).normalized()),
                          0.1)  // assimp computes in single precision
                    << name << " " << channel.mNodeName.C_Str() << " frame " << frame;
                ++compared;
            }
        }
        EXPECT_EQ(compared, 4 * motion.skeleton.joint_count());
    }
}

TEST(Motions, CalibrationPosesOfTheTestModelsAreFound) {
    EXPECT_EQ(load_bvh(model_path("BVH/01_01.bvh")).frame_count(), 2752 - 1);
    EXPECT_EQ(load_bvh(model_path("BVH/01_03.bvh")).frame_count(), 4511 - 1);
    EXPECT_EQ(load_bvh(model_path("BVH/Boxing_Toes.bvh")).frame_count(), 3069);
}

TEST(Motions, AreFoundByName) {
    const Motion motion = load_motion_by_name("01_01");
    EXPECT_EQ(motion.frame_count(), 224);
    EXPECT_DOUBLE_EQ(motion.frame_time, 1.0 / 30.0);
    EXPECT_NEAR(load_motion_by_name("Boxing_Toes").duration(), 30.68, 0.04);
    EXPECT_GT(load_motion_by_name(model_path("BVH/01_03.bvh")).frame_count(), 1000);
    expect_load_error([] { load_motion_by_name("99_99"); }, "99_99", "01_01 01_03 Boxing_Toes");
    expect_load_error([] { list_motions("/no/such/folder"); }, "/no/such/folder", "not a folder");
}

TEST_F(MotionFile, AnyFileThatExistsIsRead) {
    const std::string text = with_frames("0 0 0 0 0 0 0 0 0\n", 1);
    for (const std::string name : {"WALK.BVH", "walk.bvh", "walk", "walk.txt"})
        EXPECT_EQ(load_motion_by_name(write(name, text)).frame_count(), 1) << name;
    EXPECT_EQ(list_motions(path("")),
              (std::vector<std::string>{path("WALK.BVH"), path("walk.bvh")}));
    expect_load_error([&] { load_motion_by_name(write("notes", "a walk\n")); }, path("notes"),
                      "does not begin with HIERARCHY");
    expect_load_error([&] { load_motion_by_name(path("")); }, path(""), "is a folder");
}

TEST_F(MotionFile, ANumberIsThatOfOneClip) {
    const char* const variable = "CLOTH_SHARED_DATA";
    const char* const before = std::getenv(variable);
    const std::string old = before ? before : "";
    setenv(variable, path("").c_str(), 1);
    std::filesystem::create_directories(path("motions/train"));
    for (const std::string name : {"90_1_walk", "90_2_run", "90_2_run_fast", "91_1_walk"})
        write("motions/train/" + name + ".bvh", with_frames("0 0 0 0 0 0 0 0 0\n", 1));
    EXPECT_EQ(load_motion_by_name("90_1").name, "90_1_walk");
    EXPECT_EQ(load_motion_by_name("91").name, "91_1_walk");
    EXPECT_EQ(load_motion_by_name("90_2_run").name, "90_2_run") << "a whole name";
    expect_load_error([] { load_motion_by_name("90"); }, "90",
                      "several motions are called so. Remedy: give one of: 90_1_walk 90_2_run");
    before ? setenv(variable, old.c_str(), 1) : unsetenv(variable);
}

TEST(Motions, TheCutOf0101IsTheSharedClip) {
    const auto file = shared_data_path("motions/validation/01_01_forward_jumps_turn.bvh");
    if (!file) GTEST_SKIP() << "the shared data folder is not present";
    const Motion shared = load_bvh(*file);
    const Motion ours = load_motion_by_name("01_01");
    ASSERT_EQ(shared.frame_count(), ours.frame_count());
    for (const std::string name : {"Hips", "LeftLeg", "RightForeArm", "Head"}) {
        const int a = shared.skeleton.find(name).value();
        const int b = ours.skeleton.find(name).value();
        for (int k : {0, 100, 223})
            EXPECT_LT(
                distance_in_degrees(shared.frames[k].rotations[a], ours.frames[k].rotations[b]),
                0.1)
                << name << " frame " << k;
    }
}

TEST(Motions, SharedClipsHaveNoCalibrationPose) {
    const auto folder = shared_data_path("motions/validation");
    if (!folder) GTEST_SKIP() << "the shared data folder is not present";
    EXPECT_EQ(list_motions(*folder).size(), 4u);
    for (const std::string& file : list_motions(*folder))
        EXPECT_EQ(load_bvh(file).frame_count(),
                  load_bvh(file, {0.0, FirstFrame::keep}).frame_count())
            << file;
}

}  // namespace cloth::motion_test
