#include "data/body/body.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "data/core/paths.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::body_test {

using namespace cloth::test;

namespace {

const Body& default_body() {
    static const Body body = Body::load_default();
    return body;
}

JointTransforms everywhere(const Eigen::Isometry3d& transform) {
    return JointTransforms(default_body().joints().size(), transform);
}

/// Generalised winding number (Jacobson et al. 2013): 1 inside, 0 outside a closed surface.
double winding_number(const Vec3& p, const Points& x, const Faces& faces) {
    double sum = 0.0;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vec3 a = x.row(faces(f, 0)).transpose() - p;
        const Vec3 b = x.row(faces(f, 1)).transpose() - p;
        const Vec3 c = x.row(faces(f, 2)).transpose() - p;
        const double la = a.norm(), lb = b.norm(), lc = c.norm();
        sum += 2.0 * std::atan2(a.dot(b.cross(c)),
                                la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return sum / (4.0 * M_PI);
}

std::string side_of(const std::string& joint) {
    for (const std::string side : {"Left", "Right"})
        if (joint.rfind(side, 0) == 0) return side;
    return "";
}

}  // namespace

TEST(Body, IsThePersonOfTheTestModels) {
    const Points& rest = default_body().rest();
    EXPECT_EQ(rest.rows(), 13380);
    EXPECT_EQ(default_body().faces()->rows(), 2 * 13378);
    EXPECT_NEAR(rest.col(1).maxCoeff(), 1.659, 0.002);
    EXPECT_NEAR(rest.col(1).minCoeff(), 0.0, 0.001);
    EXPECT_NEAR(default_body().leg_length(), 0.80, 0.01);
    const Vec3 heel = default_body().point("LeftHeel"), toe = default_body().point("LeftBigToeTip");
    EXPECT_GT(toe.z(), heel.z());  // faces +z
    EXPECT_GT(heel.x(), 0.0);      // its left is +x
}

TEST(Body, HasTheJointsOfTheCmuSkeletonInsideItsSkin) {
    const std::vector<Joint>& joints = default_body().joints();
    ASSERT_EQ(joints.size(), 25u);
    std::set<std::string> names;
    for (size_t j = 0; j < joints.size(); ++j) {
        names.insert(joints[j].name);
        EXPECT_LT(joints[j].parent, static_cast<int>(j));
        EXPECT_NEAR(
            winding_number(joints[j].position, default_body().rest(), *default_body().faces()), 1.0,
            1e-6)
            << joints[j].name;
    }
    EXPECT_EQ(names.size(), 25u);
    EXPECT_EQ(joints[0].name, "Hips");
    EXPECT_EQ(joints[default_body().joint("LeftForeArm")].parent, default_body().joint("LeftArm"));
    EXPECT_THROW(default_body().joint("Tail"), ArgumentError);
    EXPECT_THROW(default_body().point("Tail"), ArgumentError);
}

TEST(Body, WeightsSumToOneWithFewInfluences) {
    const SkinWeights& weights = default_body().weights();
    ASSERT_EQ(weights.vertex_count(), 13380);
    for (int i = 0; i < weights.vertex_count(); ++i) {
        double sum = 0.0;
        for (int k = weights.begin[i]; k < weights.begin[i + 1]; ++k) sum += weights.values[k];
        ASSERT_NEAR(sum, 1.0, 1e-12) << i;
        ASSERT_LE(weights.begin[i + 1] - weights.begin[i], 6) << i;
    }
}

TEST(Body, LimbsDoNotPullEachOther) {
    const Body& body = default_body();
    const std::vector<int> dominant = body.dominant_joint();
    const std::set<std::string> trunk_pullers = {"Leg",     "Foot", "ToeBase",
                                                 "ForeArm", "Hand", "FingerBase"};
    for (int i = 0; i < body.weights().vertex_count(); ++i) {
        const std::string owner = body.joints()[dominant[i]].name;
        const std::string side = side_of(owner);
        for (size_t j = 0; j < body.joints().size(); ++j) {
            const std::string name = body.joints()[j].name;
            const std::string part = name.substr(side_of(name).size());
            if (side_of(name) == side || trunk_pullers.count(part) == 0) continue;
            // Below knees and elbows, nothing moves the other side or the trunk.
            ASSERT_LT(body.weights().at(i, static_cast<int>(j)), 0.02)
                << "vertex " << i << " of " << owner << " follows " << name;
        }
    }
}

TEST(Body, FacesAreLabelledByLimb) {
    const Body& body = default_body();
    const std::vector<std::uint8_t>& limbs = *body.limbs();
    ASSERT_EQ(limbs.size(), static_cast<size_t>(body.faces()->rows()));
    EXPECT_EQ(std::set<int>(limbs.begin(), limbs.end()).size(), 10u);
    const auto limb_near = [&](const Vec3& point) {
        double nearest = 1e9;
        int limb = -1;
        for (Eigen::Index f = 0; f < body.faces()->rows(); ++f) {
            const double distance =
                (body.rest().row((*body.faces())(f, 0)).transpose() - point).norm();
            if (distance < nearest) nearest = distance, limb = limbs[static_cast<size_t>(f)];
        }
        return limb;
    };
    const auto limb_at = [&](const std::string& joint) {
        return limb_near(body.joints()[static_cast<size_t>(body.joint(joint))].position);
    };
    EXPECT_EQ(limb_at("Spine"), limb_at("Spine1"));
    std::set<int> different = {limb_at("Spine"), limb_near(body.point("HeadTop"))};
    for (const std::string side : {"Left", "Right"}) {
        EXPECT_EQ(limb_at(side + "Hand"), limb_at(side + "FingerBase"));
        EXPECT_EQ(limb_at(side + "Foot"), limb_at(side + "ToeBase"));
        different.insert({limb_at(side + "Hand"), limb_at(side + "Foot")});
    }
    EXPECT_EQ(different.size(), 6u);
}

TEST(Body, FingersFollowTheirHandAlone) {
    const Body& body = default_body();
    const double wrist = body.joints()[body.joint("LeftFingerBase")].position.x();
    int fingers = 0;
    for (Eigen::Index i = 0; i < body.rest().rows(); ++i) {
        if (body.rest()(i, 0) < wrist + 0.03) continue;
        EXPECT_GT(body.weights().at(static_cast<int>(i), body.joint("LeftFingerBase")), 0.95) << i;
        ++fingers;
    }
    EXPECT_GT(fingers, 500);
}

TEST(Body, SkinningKeepsRestAndRigidMotions) {
    const Points& rest = default_body().rest();
    EXPECT_LT((default_body().skin(everywhere(Eigen::Isometry3d::Identity())) - rest)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-12);
    const Eigen::Isometry3d move =
        Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized());
    const Points moved = default_body().skin(everywhere(move));
    for (Eigen::Index i = 0; i < rest.rows(); i += 100)
        EXPECT_LT((moved.row(i).transpose() - move * Vec3(rest.row(i))).norm(), 1e-12);
    EXPECT_THROW(default_body().skin({}), ArgumentError);
}

TEST(Body, AnotherShapeMovesTheJointsAndKeepsTheWeights) {
    const Body& body = default_body();
    Points taller = body.rest();
    taller.col(1) *= 1.1;
    const Body other = body.with_rest(taller);
    EXPECT_EQ(&other.weights(), &body.weights());
    EXPECT_EQ(other.faces(), body.faces());
    for (size_t j = 0; j < body.joints().size(); ++j)
        EXPECT_NEAR(other.joints()[j].position.y(), 1.1 * body.joints()[j].position.y(), 1e-12);
    EXPECT_THROW(body.with_rest(taller.topRows(5)), ArgumentError);
    taller(7, 0) = std::nan("");
    EXPECT_THROW(body.with_rest(taller), ArgumentError);
}

using RigRecipeFile = FileTest;

TEST_F(RigRecipeFile, BrokenRecipesNameTheEntry) {
    const auto recipe = [](const std::string& points, const std::string& joints,
                           const std::string& bones) {
        return "{\"mesh\": {\"file\": \"a\", \"name\": \"b\", \"vertices\": 4}, \"points\": {" +
               points + "}, \"joints\": [" + joints + "], \"bones\": [" + bones + "]}";
    };
    const std::string point = "\"P\": {\"vertices\": [0, 1], \"weights\": [0.5, 0.5]}";
    const std::string joint = "{\"name\": \"J\", \"parent\": null, \"point\": \"P\"}";
    const std::string bone = "{\"joint\": \"J\", \"from\": \"P\", \"to\": \"P\"}";
    EXPECT_EQ(load_rig_recipe(write("good.json", recipe(point, joint, bone))).joints.size(), 1u);

    const std::string child = ", {\"name\": \"K\", \"parent\": \"L\", \"point\": \"P\"}";
    const std::pair<std::string, std::string> broken[] = {
        {"", "parse error"},
        {recipe(point, joint, bone).substr(0, 60), "parse error"},
        {"{}", "'mesh' not found"},
        {recipe("\"P\": {\"vertices\": [0, 1], \"weights\": [0.5, 0.4]}", joint, bone),
         "point P: its weights do not sum to 1"},
        {recipe("\"P\": {\"vertices\": [0, 9], \"weights\": [0.5, 0.5]}", joint, bone),
         "point P: vertex 9 is out of range"},
        {recipe("\"P\": {\"vertices\": [0], \"weights\": [0.5, 0.5]}", joint, bone),
         "point P: needs one weight per vertex"},
        {recipe(point, joint + child, bone), "joint K: unknown name 'L'"},
        {recipe(point, joint, "{\"joint\": \"J\", \"from\": \"Q\", \"to\": \"P\"}"),
         "bone 0: unknown name 'Q'"},
        {recipe(point, joint, ""), "holds no joints or no bones"},
    };
    for (const auto& [text, message] : broken) {
        const std::string file = write("broken.json", text);
        expect_load_error([&] { load_rig_recipe(file); }, file, message);
    }
    expect_load_error([&] { load_rig_recipe(path("")); }, path(""), "is a folder");
}

TEST_F(RigRecipeFile, ARecipeForAnotherMeshIsRefused) {
    RigRecipe recipe = load_rig_recipe(asset_path("body_rig.json"));
    TriMesh cube;
    cube.vertices = Points::Random(8, 3);
    EXPECT_THROW(Body(cube, recipe), ArgumentError);
}

}  // namespace cloth::body_test
