#include "gnn/train/skinned_start.h"

#include <gtest/gtest.h>

#include "collision/proximity/metrics.h"
#include "data/core/errors.h"
#include "data/files/garment_assets.h"

namespace cloth::skinned_start_test {
namespace {

class SkinnedStart : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        s_body = new AnimatedBody(std::make_shared<const Body>(Body::load_default()),
                                  load_motion_by_name("01_01"));
        s_garment = new Garment(load_garment("tshirt_1000"));
    }
    static void TearDownTestSuite() {
        delete s_body;
        delete s_garment;
    }

    ClothState start(const SkinnedStartSettings& settings, double time) const {
        SceneRandom random(1);
        return skinned_start(*s_garment, s_garment->rest().vertices, *s_body, settings, time, m_dt,
                             random);
    }

    static AnimatedBody* s_body;
    static Garment* s_garment;
    const double m_dt = 1.0 / 30.0;
};
AnimatedBody* SkinnedStart::s_body = nullptr;
Garment* SkinnedStart::s_garment = nullptr;

TEST_F(SkinnedStart, StandsOutsideOfTheBodyWithItsNoise) {
    SkinnedStartSettings settings;
    settings.at_rest = 1.0;
    const ClothState state = start(settings, 4.0);
    EXPECT_EQ(state.v.norm(), 0.0);
    EXPECT_DOUBLE_EQ(state.time, 4.0);
    Boundary boundary;
    boundary.obstacles = {s_body->obstacle(4.0, 4.0)};
    Proximity proximity;
    EXPECT_LT(measure_penetration(proximity, boundary, *s_garment, state.x).fraction_inside, 0.01);
    settings.noise = 0.0;
    const Points smooth = start(settings, 4.0).x;
    const double noise = std::sqrt((state.x - smooth).squaredNorm() / state.x.size());
    EXPECT_NEAR(noise, 3e-3, 1e-3);
}

TEST_F(SkinnedStart, MovesLikeTheSkinWhereItIsNotAtRest) {
    SkinnedStartSettings settings;
    settings.at_rest = 0.0;
    const ClothState state = start(settings, 4.0);
    const Points skin = (s_body->vertices(4.0) - s_body->vertices(4.0 - m_dt)) / m_dt;
    EXPECT_GT(state.v.rowwise().norm().mean(), 0.01);
    EXPECT_LT(state.v.rowwise().norm().maxCoeff(), 1.5 * skin.rowwise().norm().maxCoeff());
}

TEST_F(SkinnedStart, RefusesSettingsOutOfRange) {
    SkinnedStartSettings settings;
    settings.noise = 0.5;
    EXPECT_THROW(settings.check(), ArgumentError);
    settings = {};
    settings.share = -0.1;
    EXPECT_THROW(settings.check(), ArgumentError);
}

}  // namespace
}  // namespace cloth::skinned_start_test
