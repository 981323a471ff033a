#include "collision/proximity.h"

#include <gtest/gtest.h>

#include "collision/brute_force.h"
#include "test_meshes.h"

namespace cloth {
namespace {

using namespace test;

void expect_equal_to_brute_force(const Points& x, const Boundary& boundary, double radius) {
    Proximity proximity({radius, 0});
    SurfaceContacts contacts;
    proximity.query(x, boundary, contacts);
    int found = 0, inside = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const double expected =
            brute_force_signed_distance(boundary, StepEnd::start, x.row(i).transpose());
        if (std::abs(expected) > radius) {
            EXPECT_FALSE(contacts.has(i));
            EXPECT_EQ(contacts.distance[i], std::numeric_limits<double>::infinity());
            continue;
        }
        ASSERT_TRUE(contacts.has(i));
        ++found, inside += expected < 0;
        EXPECT_NEAR(contacts.distance[i], expected, 1e-12) << "point " << i;
        const double reached = (contacts.point0.row(i) - x.row(i)).norm();
        EXPECT_NEAR(reached, std::abs(expected), 1e-12);
        EXPECT_NEAR(contacts.normal0.row(i).norm(), 1.0, 1e-12);
        EXPECT_NEAR(contacts.barycentric.row(i).sum(), 1.0, 1e-12);
    }
    EXPECT_GT(found, 50);
    EXPECT_GT(inside, 10);
}

TEST(Proximity, EqualsBruteForceOnRandomMeshes) {
    std::mt19937 random(1);
    for (const TriMesh& mesh : {icosphere(0), roughened(icosphere(2), 0.3, 2),
                                torus(40, 20, 0.8, 0.3), roughened(torus(15, 7, 0.8, 0.3), 0.2, 3)})
        expect_equal_to_brute_force(random_points(random, 1500, 1.3), {{mesh_obstacle(mesh)}}, 0.4);
}

}  // namespace
}  // namespace cloth
