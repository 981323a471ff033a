#include "data/body/body_shapes.h"

#include <cmath>

#include "data/body/body.h"
#include "data/core/paths.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::body_shapes_test {

using namespace cloth::test;

using ShapeTargetFile = FileTest;

TEST_F(ShapeTargetFile, RowsAreIndexAndOffset) {
    const ShapeTarget target =
        load_shape_target(write("a.target", "# comment\n3 .5 -1 0\n\n7 0 0 2e-1 # why\n"), 8);
    EXPECT_EQ(target.vertices, (std::vector<int>{3, 7}));
    EXPECT_EQ(Vec3(target.offsets.row(0)), Vec3(0.5, -1.0, 0.0));
    EXPECT_EQ(Vec3(target.offsets.row(1)), Vec3(0.0, 0.0, 0.2));
}

TEST_F(ShapeTargetFile, BrokenRowsNameTheLine) {
    for (const std::string row : {"3 0 0", "x 0 0 0", "8 0 0 0", "-1 0 0 0", "3 0 0 0 0",
                                  "3 0 nan 0", "3 0 inf 0", "3 0 zero 0"}) {
        const std::string file = write("b.target", "0 0 0 0\n" + row + "\n");
        expect_load_error([&] { load_shape_target(file, 8); }, file, "line 2");
    }
    expect_load_error([&] { load_shape_target(path("none"), 8); }, "none", "cannot be opened");
    expect_load_error([&] { load_shape_target(path(""), 8); }, path(""), "is a folder");
    expect_load_error([&] { BodyShapes shapes(path("folder")); }, "base.obj", "cannot be opened");
}

TEST(BodyShapes, SamplesDependOnTheSeedAlone) {
    const BodyShape a = sample_body_shape(7), b = sample_body_shape(7), c = sample_body_shape(8);
    EXPECT_EQ(a.weight, b.weight);
    EXPECT_EQ(a.limbs, b.limbs);
    EXPECT_NE(a.weight, c.weight);
    double mean_female = 0.0;
    for (uint64_t seed = 0; seed < 400; ++seed) {
        const BodyShape shape = sample_body_shape(seed);
        mean_female += shape.female / 400.0;
        EXPECT_GE(shape.african, 0.0);
        EXPECT_GE(shape.asian, 0.0);
        EXPECT_LE(shape.african + shape.asian, 1.0);
        EXPECT_LE(std::abs(shape.height - 0.5), 0.125);
    }
    EXPECT_NEAR(mean_female, 0.5, 0.05);
}

TEST(BodyShapes, FitTheDefaultBodyAndKeepItsJointsInside) {
    const auto shapes = BodyShapes::load_shared();
    if (!shapes) GTEST_SKIP() << "the shared data folder is not present";
    const Body body = Body::load_default();
    EXPECT_LT((shapes->skin({}) - body.rest()).rowwise().norm().maxCoeff(), 0.0015);

    double shortest = 3.0, tallest = 0.0;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        const Body other = body.with_rest(shapes->skin(sample_body_shape(seed)));
        const double height = other.rest().col(1).maxCoeff();
        shortest = std::min(shortest, height);
        tallest = std::max(tallest, height);
        EXPECT_NEAR(other.rest().col(1).minCoeff(), 0.0, 1e-12);
        EXPECT_NO_THROW(validate_mesh("shape", other.rest_mesh()));
        // Joints keep their proportions: knees at about 29 % of the height.
        EXPECT_NEAR(other.joints()[other.joint("LeftLeg")].position.y() / height, 0.29, 0.02);
    }
    EXPECT_GT(shortest, 1.35);
    EXPECT_LT(tallest, 2.05);
    EXPECT_GT(tallest - shortest, 0.2);
}

TEST(BodyShapes, SlidersDoWhatTheySay) {
    const auto shapes = BodyShapes::load_shared();
    if (!shapes) GTEST_SKIP() << "the shared data folder is not present";
    const auto height = [&](const BodyShape& shape) {
        return shapes->skin(shape).col(1).maxCoeff();
    };
    BodyShape man, woman, tall;
    man.female = 0.0;
    woman.female = 1.0;
    tall.height = 0.6;
    EXPECT_NEAR(height(man), 1.730, 0.005);  // MakeHuman's averages
    EXPECT_NEAR(height(woman), 1.590, 0.005);
    EXPECT_GT(height(tall), height({}) + 0.1);
    const auto depth_of_waist = [&](double slider) {
        BodyShape shape;
        shape.waist = slider;
        const Points skin = shapes->skin(shape);
        double front = -1.0;
        for (Eigen::Index i = 0; i < skin.rows(); ++i)
            if (std::abs(skin(i, 1) - 1.03) < 0.02 && std::abs(skin(i, 0)) < 0.1)
                front = std::max(front, skin(i, 2));
        return front;
    };
    EXPECT_GT(depth_of_waist(1.0), depth_of_waist(0.0) + 0.01);
    EXPECT_LT(depth_of_waist(-1.0), depth_of_waist(0.0) - 0.005);
}

}  // namespace cloth::body_shapes_test
