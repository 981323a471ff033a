// Garments of all kinds, stepped by every stepper. README.md says what must hold.

#include <gtest/gtest.h>

#include <memory>

#include "data/core/errors.h"
#include "tests/fuzz/fuzz_meshes.h"
#include "tests/fuzz/fuzz_steppers.h"
#include "tests/test_meshes.h"

namespace cloth::test {
namespace {

constexpr int frames = 5;

/// Nothing if the mesh, fabric or pins were refused with a message that names the garment.
std::unique_ptr<Garment> made(TriMesh mesh, const Fabric& fabric, std::vector<int> pins,
                              bool rest_angles) {
    try {
        return std::make_unique<Garment>("fuzzed", std::move(mesh), fabric, std::move(pins),
                                         rest_angles);
    } catch (const ArgumentError& error) {
        EXPECT_NE(std::string(error.what()).find("fuzzed"), std::string::npos) << error.what();
    }
    return nullptr;
}

/// A ball through the garment's middle, a tenth as wide.
Obstacle ball_in(const TriMesh& mesh) {
    const Vec3 low = mesh.vertices.colwise().minCoeff(), high = mesh.vertices.colwise().maxCoeff();
    Obstacle ball = test::primitive(ObstacleShape::sphere, Vec3::Zero(), 0.1 * (high - low).norm());
    ball.pose0.translation() = 0.5 * (low + high);
    ball.pose1 = ball.pose0;
    return ball;
}

void step_with_all(const Garment& garment, const Boundary& boundary) {
    for (const StepperKind& kind : stepper_kinds()) {
        SCOPED_TRACE(kind.name);
        std::unique_ptr<Stepper> stepper;
        ASSERT_NO_THROW(stepper = kind.make(garment));
        ClothState state = ClothState::at_rest(garment);
        for (int frame = 0; frame < frames; ++frame)
            ASSERT_EQ(checked_step(*stepper, garment, boundary, 1.0 / 30.0, state), "") << frame;
    }
}

TEST(GarmentsFuzz, AreRefusedByNameOrStepped) {
    int stepped = 0, refused = 0;
    for_each_seed(100, [&](unsigned seed) {
        SCOPED_TRACE(repeat_with(seed));
        Random random(seed);
        TriMesh mesh = random_mesh(random);
        const int count = static_cast<int>(mesh.vertices.rows());
        const Fabric fabric = random_fabric(random);
        const auto garment =
            made(std::move(mesh), fabric, random_pins(random, count), random.chance(0.3));
        if (!garment) {
            ++refused;
            return;
        }
        ++stepped;
        Boundary boundary;
        boundary.pin_targets = garment->rest().vertices(garment->pins(), Eigen::all);
        if (random.chance(0.5)) boundary.obstacles.push_back(ball_in(garment->rest()));
        step_with_all(*garment, boundary);
    });
    RecordProperty("stepped", stepped);
    RecordProperty("refused", refused);
}

TEST(GarmentsFuzz, FabricsOutOfRangeAreRefusedByField) {
    for (const double value : {-1.0, 0.0 / 0.0, 1.0 / 0.0})
        for (double Fabric::*field :
             {&Fabric::density, &Fabric::mu, &Fabric::lambda, &Fabric::bending}) {
            Fabric fabric;
            fabric.*field = value;
            EXPECT_EQ(made(plain_sheet(3), fabric, {}, false), nullptr);
        }
}

}  // namespace
}  // namespace cloth::test
