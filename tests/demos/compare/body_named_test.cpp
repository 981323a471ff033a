#include "demos/compare/body_named.h"

#include <gtest/gtest.h>

#include "demos/compare/arguments.h"
#include "demos/compare/body_scene.h"

namespace cloth::body_named_test {

TEST(BodyNamed, NamesAndNumbersAreShapes) {
    EXPECT_EQ(body_shape_named("default").weight, BodyShape{}.weight);
    EXPECT_LT(body_shape_named("slight").weight, body_shape_named("heavy").weight);
    EXPECT_EQ(body_shape_named("7").height, sample_body_shape(7).height);
    for (const char* name : {"", "tall", "-1", "1.5", "99999999999"})
        EXPECT_THROW(body_shape_named(name), UsageError) << name;
}

TEST(BodyNamed, TheDefaultNeedsNoShapes) {
    EXPECT_EQ(body_named("default")->rest(), Body::load_default().rest());
}

TEST(BodyNamed, OthersAreDressedByTheScene) {
    BodySceneSettings settings;
    settings.garment = "pants_1000";
    settings.body = "heavy";
    if (!BodyShapes::load_shared()) {
        EXPECT_THROW(BodyScene{settings}, UsageError);
        GTEST_SKIP() << "no shared data";
    }
    const BodyScene scene(settings);
    EXPECT_NE(scene.body().body().rest(), Body::load_default().rest());
    const double time = -scene.lead_in_frames() * scene.frame_time();
    EXPECT_EQ(scene.loss(scene.boundary(time, time), scene.start().x), "");
}

}  // namespace cloth::body_named_test
