#include "collision/proximity/limb_boxes.h"

#include <gtest/gtest.h>

#include "collision/proximity/brute_force.h"
#include "tests/test_meshes.h"

namespace cloth::limb_boxes_test {
namespace {

using namespace test;

/// A ball in four slices along y, which are limbs 3, 7, 11 and 31.
Obstacle slices(std::mt19937& random) {
    const TriMesh ball = roughened(icosphere(3), 0.2, 5);
    Obstacle obstacle = mesh_obstacle(ball);
    const std::uint8_t numbers[] = {3, 7, 11, 31};
    auto limbs = std::make_shared<std::vector<std::uint8_t>>();
    for (Eigen::Index f = 0; f < ball.faces.rows(); ++f) {
        const double y = ball.vertices(ball.faces(f, 0), 1);
        limbs->push_back(numbers[std::clamp(int(2.0 + 2.0 * y), 0, 3)]);
    }
    obstacle.limbs = limbs;
    const Vec3 motion = random_point(random, 3.0);
    obstacle.x1.rowwise() += motion.transpose();
    return obstacle;
}

bool is_near_box(const Obstacle& obstacle, const Points& vertices, int limb, const Vec3& x,
                 double reach) {
    Vec3 low = Vec3::Constant(1e9), high = -low;
    for (Eigen::Index f = 0; f < obstacle.faces->rows(); ++f)
        for (int k = 0; k < 3 && (*obstacle.limbs)[size_t(f)] == limb; ++k) {
            low = low.cwiseMin(vertices.row((*obstacle.faces)(f, k)).transpose());
            high = high.cwiseMax(vertices.row((*obstacle.faces)(f, k)).transpose());
        }
    return (x.array() >= low.array() - reach).all() && (x.array() <= high.array() + reach).all();
}

TEST(LimbBoxes, AreNearPointsAndAlongRaysAtEitherEnd) {
    std::mt19937 random(3);
    int met = 0;
    for (int trial = 0; trial < 20; ++trial) {
        const Boundary boundary =
            boundary_of({primitive(ObstacleShape::sphere, Vec3::Zero(), 1.0), slices(random)});
        const Obstacle& body = boundary.obstacles[1];
        LimbBoxes boxes;
        for (const StepEnd end : {StepEnd::end, StepEnd::start}) {
            boxes.fit(boundary, {0, 1}, end);
            const Points& vertices = end == StepEnd::start ? body.x0 : body.x1;
            for (int k = 0; k < 200; ++k) {
                const Vec3 x = random_point(random, 4.0);
                const double reach = uniform(random, 0.0, 0.3);
                LimbSet expected = 0;
                for (int limb = 0; limb < max_limbs; ++limb)
                    if (is_near_box(body, vertices, limb, x, reach)) expected |= LimbSet(1) << limb;
                EXPECT_EQ(boxes.near(x, reach), expected);
            }
        }
        for (int k = 0; k < 200; ++k) {  // at the start
            const Vec3 x = random_point(random, 2.0);
            const Vec3 direction =
                k % 10 == 0 ? Vec3::Unit(k / 10 % 3) : Vec3(random_point(random, 1.0).normalized());
            const double length = uniform(random, 0.1, 3.0);
            LimbSet on_it = 0, around_it = 0;
            for (double at = 0.0; at <= length; at += 1e-3)
                on_it |= boxes.near(x + at * direction, 0.0);
            for (double at = 0.0; at <= length + 1e-3; at += 1e-3)
                around_it |= boxes.near(x + at * direction, 3e-3);
            const LimbSet found = boxes.along(x, direction, length);
            EXPECT_EQ(on_it & ~found, 0u);
            EXPECT_EQ(found & ~around_it, 0u);
            met += on_it != 0;
        }
    }
    EXPECT_GT(met, 300);
}

constexpr float far = std::numeric_limits<float>::infinity();

/// By std::nextafter(), one limb after the other.
LimbSet slow_near(const Obstacle& body, const Vec3& x, double reach) {
    const auto down = [](double at) { return std::nextafter(static_cast<float>(at), -far); };
    const auto up = [](double at) { return std::nextafter(static_cast<float>(at), far); };
    LimbSet found = 0;
    for (int limb = 0; limb < max_limbs; ++limb) {
        bool overlap = true;
        for (int k = 0; k < 3; ++k) {
            double low = far, high = -far;
            for (Eigen::Index f = 0; f < body.faces->rows(); ++f)
                for (int c = 0; c < 3 && (*body.limbs)[size_t(f)] == limb; ++c) {
                    low = std::min(low, body.x0((*body.faces)(f, c), k));
                    high = std::max(high, body.x0((*body.faces)(f, c), k));
                }
            overlap &=
                low <= high && down(low) <= up(x[k] + reach) && up(high) >= down(x[k] - reach);
        }
        if (overlap) found |= LimbSet(1) << limb;
    }
    return found;
}

TEST(LimbBoxes, RoundAsNextafterDoes) {
    std::mt19937 random(9);
    Obstacle body = slices(random);
    for (const double scale : {1.0, 1e-40, 0.0, 1e38}) {
        body.x0 = scale * mesh_obstacle(roughened(icosphere(3), 0.2, 5)).x0;
        LimbBoxes boxes;
        boxes.fit(boundary_of({body}), {1}, StepEnd::start);
        for (int k = 0; k < 60; ++k) {  // around corners of the boxes, off by single steps
            Vec3 x = body.x0.row(Eigen::Index(random() % size_t(body.x0.rows())));
            for (int axis = 0; axis < 3; ++axis)
                for (int step = int(random() % 5); step > 0; --step)
                    x[axis] = std::nextafter(static_cast<float>(x[axis]), k % 2 ? far : -far);
            if (k % 10 == 0) x[k % 3] = k % 4 ? far : -far;
            EXPECT_EQ(boxes.near(x, 0.0), slow_near(body, x, 0.0));
        }
    }
}

TEST(LimbBoxes, CopeWithWhatComesAndGoesAndWithBadMeshes) {
    std::mt19937 random(4);
    Obstacle bad = slices(random), moving = slices(random);
    bad.faces = std::make_shared<const Faces>(bad.faces->array() + 1000000);
    moving.x0.row(5).setConstant(std::nan(""));
    LimbBoxes boxes;
    boxes.fit(boundary_of({}), {}, StepEnd::start);
    EXPECT_EQ(boxes.near(Vec3::Zero(), 100.0), 0u);
    boxes.fit(boundary_of({bad}), {1}, StepEnd::start);
    EXPECT_EQ(boxes.near(Vec3::Zero(), 100.0), 0u);
    const LimbSet all = 1u << 3 | 1u << 7 | 1u << 11 | 1u << 31;
    for (int frame = 0; frame < 40; ++frame) {  // new meshes all the time
        boxes.fit(boundary_of({bad, slices(random), moving}), {1, 1, 1}, StepEnd::start);
        EXPECT_EQ(boxes.near(Vec3::Zero(), 2.0), all);
    }
    EXPECT_EQ(boxes.near(Vec3::Constant(std::nan("")), 1.0), 0u);
}

}  // namespace
}  // namespace cloth::limb_boxes_test
