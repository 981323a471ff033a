#include "data/body/joint_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/body/animated_body.h"
#include "data/core/errors.h"

namespace cloth::joint_fit_test {

namespace {

class JointFitTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        s_body = new AnimatedBody(std::make_shared<const Body>(Body::load_default()),
                                  load_motion_by_name("01_01"));
        s_fit = new JointFit(s_body->body().rest(), s_body->body().weights());
    }
    static void TearDownTestSuite() {
        delete s_body;
        delete s_fit;
    }
    static AnimatedBody* s_body;
    static JointFit* s_fit;
};
AnimatedBody* JointFitTest::s_body = nullptr;
JointFit* JointFitTest::s_fit = nullptr;

TEST_F(JointFitTest, FindsTheJointsThatASkinWasPosedWith) {
    for (const double time : {0.0, 1.0, 2.5, 4.0}) {
        const std::vector<SkinMatrix> truth = s_body->skin_matrices(time);
        std::vector<SkinMatrix> found;
        EXPECT_LT(s_fit->find(s_body->vertices(time), found), 1e-9);
        ASSERT_EQ(found.size(), truth.size());
        for (size_t j = 0; j < truth.size(); ++j)
            EXPECT_LT((found[j] - truth[j]).cwiseAbs().maxCoeff(), 1e-7) << time << " s, " << j;
    }
}

TEST_F(JointFitTest, NoiseOfTheSkinHardlyMovesThem) {
    Points skin = s_body->vertices(3.0);
    for (Eigen::Index k = 0; k < skin.size(); ++k)
        skin.data()[k] += 1e-4 * std::sin(12.9898 * static_cast<double>(k * k));
    const std::vector<SkinMatrix> truth = s_body->skin_matrices(3.0);
    std::vector<SkinMatrix> found;
    EXPECT_NEAR(s_fit->find(skin, found), std::sqrt(3.0 / 2.0) * 1e-4, 3e-5);
    const Points fitted = skin_points(s_body->body().rest(), s_body->body().weights(), found);
    EXPECT_LT((fitted - s_body->vertices(3.0)).rowwise().norm().maxCoeff(), 5e-4);
    const JointFit all(s_body->body().rest(), s_body->body().weights(), 1000000);
    EXPECT_NEAR(all.find(skin, found), std::sqrt(3.0 / 2.0) * 1e-4, 1e-5) << "of all vertices";
}

TEST_F(JointFitTest, AnotherBodyIsFarFromItsSkin) {
    Points thinner = s_body->body().rest();
    thinner.col(2) = thinner.col(2).unaryExpr([](double z) { return z + 0.02 * std::sin(60 * z); });
    const AnimatedBody other(std::make_shared<const Body>(s_body->body().with_rest(thinner)),
                             load_motion_by_name("01_01"));
    std::vector<SkinMatrix> found;
    EXPECT_GT(s_fit->find(other.vertices(3.0), found), 2e-3);
}

TEST_F(JointFitTest, SkinsThatItCannotUseAreInfinitelyFar) {
    std::vector<SkinMatrix> found;
    Points skin = s_body->vertices(1.0);
    EXPECT_TRUE(std::isinf(s_fit->find(skin.topRows(100), found)));
    skin(7, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isinf(s_fit->find(skin, found)));
    EXPECT_TRUE(found.empty());
}

TEST_F(JointFitTest, SkinsThatDoNotDetermineTheirJointsAreRefused) {
    const Points rest = s_body->body().rest();
    EXPECT_THROW(JointFit(rest, s_body->body().weights(), 7), ArgumentError);
    EXPECT_THROW(JointFit(rest.topRows(5), s_body->body().weights()), ArgumentError);
    SkinWeights same;  // two joints that move the same vertices in the same way
    same.begin = {0};
    for (int i = 0; i < 8; ++i) {
        same.joints.insert(same.joints.end(), {0, 1});
        same.values.insert(same.values.end(), {0.5, 0.5});
        same.begin.push_back(2 * i + 2);
    }
    EXPECT_THROW(JointFit(rest.topRows(8), same), ArgumentError);
    SkinWeights nothing;
    nothing.begin = {0};
    EXPECT_THROW(JointFit(Points(0, 3), nothing), ArgumentError);
}

}  // namespace

}  // namespace cloth::joint_fit_test
