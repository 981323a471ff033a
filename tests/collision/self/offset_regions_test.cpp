#include "collision/self/offset_regions.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/collision/self/self_scenes.h"

namespace cloth::offset_regions_test {
namespace {

using namespace test;

/// Faces of one piece and the vertices of another, both flat at first and then waved.
class OffsetRegionsTest : public ::testing::TestWithParam<double> {
 protected:
    MergedGarments sheets = two_sheets(3e-3, 200);
    const Garment& garment = sheets.garment;
    OffsetRegions regions{garment};
    Points x = garment.rest().vertices;

    OffsetRegionsTest() {
        for (Eigen::Index i = 0; i < x.rows(); ++i)
            x(i, 1) += GetParam() * std::sin(25 * x(i, 0)) * std::cos(31 * x(i, 2));
    }
    bool is_between_pieces(const ElementPair& pair) const {
        const int second = sheets.first_vertex[1];
        return (pair.vertex[0] < second) != (pair.vertex[3] < second);
    }
    template <typename Visit>
    void visit_faces(const Visit& visit) const {
        visit_all(garment, [&](const ElementPair& pair) {
            if (pair.edges || !is_between_pieces(pair)) return;
            visit(pair, closest_points(false, corners_of(pair, x)));
        });
    }
};

TEST_P(OffsetRegionsTest, TheFaceThatIsNearestToAVertexContainsIt) {
    std::vector<double> nearest(size_t(x.rows()), std::numeric_limits<double>::infinity());
    std::vector<char> contained(size_t(x.rows()), 0);
    visit_faces([&](const ElementPair& pair, const ClosestPoints& points) {
        const auto vertex = size_t(pair.vertex[0]);
        nearest[vertex] = std::min(nearest[vertex], points.squared);
    });
    visit_faces([&](const ElementPair& pair, const ClosestPoints& points) {
        const auto vertex = size_t(pair.vertex[0]);
        if (points.squared <= nearest[vertex] * (1.0 + 1e-9) && regions.contain(pair, points, x))
            contained[vertex] = 1;
    });
    for (size_t i = 0; i < contained.size(); ++i) EXPECT_TRUE(contained[i]) << "vertex " << i;
}

TEST_P(OffsetRegionsTest, WhereAFaceDoesNotContainAVertexAnotherIsNearer) {
    const Faces& faces = garment.rest().faces;
    int left_out = 0;
    visit_faces([&](const ElementPair& pair, const ClosestPoints& points) {
        if (points.squared > 0.01 * 0.01 || regions.contain(pair, points, x)) return;
        ++left_out;
        double nearer = points.squared;
        for (Eigen::Index f = 0; f < faces.rows(); ++f) {
            const auto shares = [&](int v) { return (faces.row(f).array() == v).any(); };
            if (!shares(pair.vertex[1]) && !shares(pair.vertex[2]) && !shares(pair.vertex[3]))
                continue;
            const ElementPair other{{pair.vertex[0], faces(f, 0), faces(f, 1), faces(f, 2)},
                                    {pair.vertex[0], static_cast<int>(f)},
                                    false};
            nearer = std::min(nearer, closest_points(false, corners_of(other, x)).squared);
        }
        EXPECT_LT(nearer, points.squared);
    });
    EXPECT_GT(left_out, 100);
}

TEST_P(OffsetRegionsTest, EdgesThatAreContainedLookAcrossTheirSurfaces) {
    int contained = 0, left_out = 0;
    visit_all(garment, [&](const ElementPair& pair) {
        if (!pair.edges || !is_between_pieces(pair)) return;
        const ClosestPoints points = closest_points(true, corners_of(pair, x));
        if (!points.facing || points.squared > 0.01 * 0.01) return;
        if (!regions.contain(pair, points, x)) {
            ++left_out;
            return;
        }
        ++contained;
        // A wave of slope s turns the surfaces by as much, and edges may slant by 0.1 besides.
        const double slope = GetParam() * 31;
        const double across = std::abs(points.offset.y()) / std::sqrt(points.squared);
        const bool at_border = pair.element[0] >= 0 && (std::abs(x(pair.vertex[0], 0)) > 0.1 ||
                                                        std::abs(x(pair.vertex[0], 2)) > 0.1);
        if (!at_border) {
            EXPECT_GT(across, std::cos(0.25 + 2.0 * slope));
        }
    });
    EXPECT_GT(contained, 100);
    if (GetParam() == 0.0) {
        EXPECT_LT(left_out, contained);
    }
}

INSTANTIATE_TEST_SUITE_P(Waves, OffsetRegionsTest, ::testing::Values(0.0, 2e-3, 5e-3));

TEST(OffsetRegions, ABorderPushesAside) {
    const MergedGarments sheets = two_sheets(3e-3);
    const Garment& garment = sheets.garment;
    const OffsetRegions regions(garment);
    Points x = garment.rest().vertices;
    // The second sheet's left border stands 2 mm beyond the right border of the first.
    x.bottomRows(x.rows() - sheets.first_vertex[1]).col(0).array() += 0.302;
    int contained = 0;
    visit_all(garment, [&](const ElementPair& pair) {
        if (pair.edges || pair.vertex[0] < sheets.first_vertex[1] ||
            pair.vertex[1] >= sheets.first_vertex[1])
            return;
        const ClosestPoints points = closest_points(false, corners_of(pair, x));
        contained += points.squared < 4e-3 * 4e-3 && regions.contain(pair, points, x);
    });
    EXPECT_GT(contained, 3);
}

}  // namespace
}  // namespace cloth::offset_regions_test
