#include "collision/proximity/surface_samples.h"

#include <gtest/gtest.h>

#include "collision/proximity/brute_force.h"
#include "data/authoring/sheet.h"
#include "tests/collision/random_primitives.h"

namespace cloth::surface_samples_test {
namespace {

using namespace test;

constexpr double depth = 5e-4;  // m

std::vector<int> deep_by_brute_force(const SurfaceSamples& samples, const Boundary& boundary,
                                     const Points& x) {
    std::vector<int> deep;
    for (int sample = 0; sample < samples.count(); ++sample) {
        const Vec3 at = samples.corners(sample).position(x);
        if (samples.is_movable(sample) &&
            brute_force_signed_distance(boundary, StepEnd::end, at) < -depth)
            deep.push_back(sample);
    }
    return deep;
}

/// A sheet of a metre in waves as high as 10 cm, through whatever is there.
Points waves(std::mt19937& random, const Garment& garment) {
    Points x = garment.rest().vertices;
    const Vec3 wave = random_point(random, 12.0);
    const double height = uniform(random, 0.0, 0.1);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        x(i, 1) += height * std::sin(wave.dot(x.row(i).transpose()) + wave[1]);
    return x;
}

TEST(SurfaceSamples, DeepOnesAreThoseOfBruteForce) {
    std::mt19937 random(11);
    size_t all = 0, none_of = 0;
    for (const int vertices : {60, 400, 2000}) {  // edges of 14, 5 and 2 cm
        const Garment garment("sheet", make_sheet(1.0, 1.0, vertices), Fabric::soft_cotton(),
                              {0, vertices / 2});
        SurfaceSamples samples(garment);
        Proximity proximity;
        SurfaceContacts contacts;
        for (int trial = 0; trial < 12; ++trial) {
            const Boundary boundary = random_primitives(random, trial);
            Points x = waves(random, garment);
            proximity.query(x, boundary, contacts, StepEnd::end);
            samples.find_deep(proximity, boundary, x, contacts, depth, nullptr);
            EXPECT_EQ(samples.deep(), deep_by_brute_force(samples, boundary, x));
            // Then with some of the vertices moved, a few of them far.
            std::vector<char> changed(static_cast<size_t>(x.rows()), 0);
            for (Eigen::Index i = 0; i < x.rows(); i += 1 + trial) {
                if (garment.is_pinned()[static_cast<size_t>(i)]) continue;
                x.row(i) += random_point(random, i % 5 == 0 ? 0.2 : 0.02);
                changed[static_cast<size_t>(i)] = 1;
            }
            proximity.query(x, boundary, contacts, StepEnd::end);
            samples.find_deep(proximity, boundary, x, contacts, depth, &changed);
            EXPECT_EQ(samples.deep(), deep_by_brute_force(samples, boundary, x));
            all += samples.deep().size();
            none_of += samples.deep().empty();
        }
    }
    EXPECT_GT(all, 1000u);
    EXPECT_LT(none_of, 12u);
}

}  // namespace
}  // namespace cloth::surface_samples_test
