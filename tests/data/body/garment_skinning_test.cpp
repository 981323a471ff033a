#include "data/body/garment_skinning.h"

#include <gtest/gtest.h>

#include "collision/proximity/metrics.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/garment_assets.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::garment_skinning_test {

using namespace cloth::test;

namespace {

class GarmentSkinningTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        s_body = new AnimatedBody(std::make_shared<const Body>(Body::load_default()),
                                  load_motion_by_name("01_01"));
        s_garment = new Garment(load_garment("tshirt_1000"));
        s_skinning = new GarmentSkinning(skin_garment(s_garment->rest().vertices, *s_body));
    }
    static void TearDownTestSuite() {
        delete s_body;
        delete s_garment;
        delete s_skinning;
    }

    static AnimatedBody* s_body;
    static Garment* s_garment;
    static GarmentSkinning* s_skinning;
};
AnimatedBody* GarmentSkinningTest::s_body = nullptr;
Garment* GarmentSkinningTest::s_garment = nullptr;
GarmentSkinning* GarmentSkinningTest::s_skinning = nullptr;

double mean_distance(const Points& x, const Points& skin) {
    VectorX distance(x.rows());
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        distance[i] = (skin.rowwise() - x.row(i)).rowwise().norm().minCoeff();
    return distance.mean();
}

TEST_F(GarmentSkinningTest, TheRestPoseIsTheGarmentAsWorn) {
    const SkinGoals goals = skinned_goals(*s_skinning, *s_body, 0.0, 0.0);
    EXPECT_LT((goals.x1 - s_garment->rest().vertices).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((goals.normal1 - s_skinning->normals()).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_EQ(s_skinning->weights().vertex_count(), s_garment->vertex_count());
    EXPECT_LT(s_skinning->farthest(), 0.2);
}

TEST_F(GarmentSkinningTest, FollowsTheBodyInEveryPose) {
    const double at_rest = mean_distance(s_garment->rest().vertices, s_body->body().rest());
    for (const double time : {2.0, 3.0, 4.0}) {
        const SkinGoals goals = skinned_goals(*s_skinning, *s_body, time - 0.1, time);
        EXPECT_GT((goals.x1 - s_skinning->worn()).rowwise().norm().mean(), 0.1) << "it has moved";
        EXPECT_GT((goals.x1 - goals.x0).norm(), 0.0);
        EXPECT_LT(mean_distance(goals.x1, s_body->vertices(time)), 1.3 * at_rest);
        EXPECT_LT(measure_stretch(*s_garment, goals.x1).p50, 1.1);
    }
}

TEST_F(GarmentSkinningTest, NormalsPointAwayFromTheBodyInEveryPose) {
    for (const double time : {0.0, 4.0}) {
        const SkinGoals goals = skinned_goals(*s_skinning, *s_body, time, time);
        const Points skin = s_body->vertices(time);
        int outward = 0;
        for (Eigen::Index i = 0; i < goals.x1.rows(); ++i) {
            EXPECT_NEAR(goals.normal1.row(i).norm(), 1.0, 1e-9);
            Eigen::Index nearest = 0;
            (skin.rowwise() - goals.x1.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
            outward += goals.normal1.row(i).dot(goals.x1.row(i) - skin.row(nearest)) > 0.0;
        }
        EXPECT_GT(outward, 0.95 * static_cast<double>(goals.x1.rows())) << "at " << time;
    }
}

TEST(GarmentSkinning, ACharacterOfAFileTakesItsGarmentAlong) {
    // Khronos' SimpleSkin bends by 90 degrees about its middle; what is worn on its top edge, 5 cm
    // in front of it, turns as that does.
    const WeldedCharacter strip(model_path("glTF2/simple_skin/simple_skin.gltf"), {}, 1e-4);
    Points worn = strip.rest().vertices;
    worn.col(2).array() += 0.05;
    const GarmentSkinning skinning = skin_garment(worn, strip);
    const SkinGoals goals = skinned_goals(skinning, strip, 0.0, 1.0);
    EXPECT_LT((goals.x0 - worn).cwiseAbs().maxCoeff(), 1e-6);
    const Points bent = strip.vertices(1.0);
    for (Eigen::Index i = 0; i < worn.rows(); ++i)
        EXPECT_LT((goals.x1.row(i) - bent.row(i) - Eigen::RowVector3d(0, 0, 0.05)).norm(), 1e-5);
}

TEST(GarmentSkinning, ARealCharacterTakesWhatItWearsAlong) {
    CharacterSettings settings;
    settings.animation = "Wuson_Walk";
    const WeldedCharacter bison(model_path("X/Testwuson.X"), settings, 1e-4);
    const GarmentSkinning skinning = skin_garment(bison.rest().vertices, bison);
    for (const double time : {0.0, 0.5 * bison.duration()}) {
        const SkinGoals goals = skinned_goals(skinning, bison, time, time);
        const Points skin = bison.vertices(time);
        const double size = (skin.colwise().maxCoeff() - skin.colwise().minCoeff()).norm();
        EXPECT_LT((goals.x1 - skin).rowwise().norm().mean(), 0.02 * size);
    }
}

TEST(GarmentSkinning, WrongInputIsRefused) {
    const WeldedCharacter strip(model_path("glTF2/simple_skin/simple_skin.gltf"), {}, 1e-4);
    const TriMesh& skin = strip.rest();
    Points worn = skin.vertices;
    const GarmentSkinning skinning(worn, skin, strip.weights());
    Points x, normals;
    EXPECT_THROW(skinning.pose({}, x, normals), ArgumentError);
    EXPECT_THROW(GarmentSkinning(worn, {skin.vertices, Faces(0, 3)}, strip.weights()),
                 ArgumentError);
    EXPECT_THROW(
        GarmentSkinning(worn, {skin.vertices.topRows(3), skin.faces.topRows(1)}, strip.weights()),
        ArgumentError);
    worn(0, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(GarmentSkinning(worn, skin, strip.weights()), ArgumentError);
}

}  // namespace
}  // namespace cloth::garment_skinning_test
