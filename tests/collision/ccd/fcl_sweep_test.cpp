#include "collision/ccd/fcl_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/test_meshes.h"

namespace cloth::fcl_sweep_test {
namespace {

using namespace test;
using Corners = std::array<Vec3, 3>;

struct Sweep {
    Vec3 p0, p1;
    Corners start, end;
};

double volume(const Sweep& sweep, double t, Corners& at, Vec3& p) {
    for (size_t k = 0; k < 3; ++k) at[k] = (1 - t) * sweep.start[k] + t * sweep.end[k];
    p = (1 - t) * sweep.p0 + t * sweep.p1;
    return (at[1] - at[0]).cross(at[2] - at[0]).dot(p - at[0]);
}

/// Changes of side, found by 1,000 samples and bisection. `unsure`: one of them is nearer to an
/// edge than a hundredth of the triangle, or the triangle is nearly without area.
double slow_first_touch(const Sweep& sweep, bool& unsure) {
    double first = 2.0;
    unsure = false;
    Corners at;
    Vec3 p;
    double last = volume(sweep, 0.0, at, p);
    constexpr int samples = 1000;
    for (int k = 1; k <= samples; ++k) {
        const double value = volume(sweep, double(k) / samples, at, p);
        if ((value < 0) != (last < 0)) {
            double low = double(k - 1) / samples, high = double(k) / samples;
            for (int i = 0; i < 50; ++i) {
                const double middle = 0.5 * (low + high);
                ((volume(sweep, middle, at, p) < 0) != (last < 0) ? high : low) = middle;
            }
            volume(sweep, low, at, p);
            const Vec3 normal = (at[1] - at[0]).cross(at[2] - at[0]);
            double least = 1.0, sum = 0.0;
            for (size_t c = 0; c < 3; ++c) {
                const double weight = (at[(c + 1) % 3] - p).cross(at[(c + 2) % 3] - p).dot(normal) /
                                      normal.squaredNorm();
                least = std::min(least, weight);
                sum += weight;
            }
            if (least > 0.0) first = std::min(first, low);
            const double shape = normal.norm() / (at[1] - at[0]).squaredNorm();
            unsure = unsure || std::abs(least) < 0.01 || shape < 0.05 || std::abs(sum - 1) > 1e-6;
        }
        last = value;
    }
    return first;
}

/// Triangles of `size` that go with the point, but for a random motion, and are bent by `wobble`.
Sweep random_sweep(std::mt19937& random, double size, double wobble, const Vec3& origin) {
    Sweep sweep;
    const Vec3 common = random_point(random, 4 * size);
    sweep.p0 = origin + random_point(random, size);
    sweep.p1 = sweep.p0 + common + random_point(random, 2 * size);
    for (size_t k = 0; k < 3; ++k) {
        sweep.start[k] = origin + random_point(random, size);
        sweep.end[k] = sweep.start[k] + common + random_point(random, wobble * size);
    }
    return sweep;
}

/// Compares the fast test with the slow one, and says how many touches there were.
int expect_the_same(double size, double wobble, const Vec3& origin, double tolerance) {
    std::mt19937 random(7);
    int touches = 0;
    for (int k = 0; k < 1500; ++k) {
        const Sweep sweep = random_sweep(random, size, wobble, origin);
        bool unsure = false;
        const double slow = slow_first_touch(sweep, unsure);
        if (unsure) continue;
        double time = -1.0;
        const bool touch = first_touch(sweep.p0, sweep.p1, sweep.start, sweep.end, time);
        EXPECT_EQ(touch, slow <= 1.0) << "sweep " << k;
        if (touch) {
            EXPECT_NEAR(time, slow, tolerance) << "sweep " << k;
            ++touches;
        } else {
            EXPECT_EQ(time, -1.0);
        }
    }
    return touches;
}

TEST(FclSweep, FindsWhatSamplesFind) {
    for (const double wobble : {1.0, 0.1, 1e-3, 0.0}) {
        EXPECT_GT(expect_the_same(0.01, wobble, Vec3::Zero(), 1e-6), 40) << wobble;
        EXPECT_GT(expect_the_same(2.0, wobble, Vec3::Zero(), 1e-6), 40) << wobble;
    }
}

TEST(FclSweep, WorksFarFromTheOrigin) {
    EXPECT_GT(expect_the_same(0.01, 0.1, Vec3(1000, -1000, 1000), 1e-6), 40);
}

TEST(FclSweep, ThingsThatDoNotMoveOrHaveNoAreaDoNotTouch) {
    const Corners triangle{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    double time = -1.0;
    const Vec3 above(0.2, 0.2, 1.0);
    EXPECT_FALSE(first_touch(above, above, triangle, triangle, time));
    const Corners point{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    EXPECT_FALSE(first_touch(Vec3(0, 0, 1), Vec3(0, 0, -1), point, point, time));
    EXPECT_FALSE(first_touch(Vec3::Zero(), Vec3::Zero(), point, point, time));
    EXPECT_EQ(time, -1.0);
}

}  // namespace
}  // namespace cloth::fcl_sweep_test
