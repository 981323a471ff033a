#include "data/body/segment_grid.h"

#include <gtest/gtest.h>

#include <random>

#include "data/core/paths.h"
#include "data/files/mesh_io.h"

namespace cloth::segment_grid_test {

TEST(SegmentGrid, ASegmentHitsTheSquareItCrosses) {
    Points x(4, 3);
    x << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
    Faces faces(2, 3);
    faces << 0, 1, 2, 0, 2, 3;
    const SegmentGrid grid(x, faces, 0.3);
    EXPECT_TRUE(grid.hits(Vec3(0.7, 0.2, -1), Vec3(0.7, 0.2, 1)));
    EXPECT_TRUE(grid.hits(Vec3(-2, -2, -2), Vec3(2.5, 2.5, 1.9)));  // starts and ends far outside
    EXPECT_FALSE(grid.hits(Vec3(0.7, 0.2, -1), Vec3(0.7, 0.2, -0.1)));
    EXPECT_FALSE(grid.hits(Vec3(1.2, 0.2, -1), Vec3(1.2, 0.2, 1)));
}

TEST(SegmentGrid, AgreesWithTestingEveryFace) {
    const TriMesh duck = load_mesh(model_path("Collada/duck.dae"));
    const Vec3 low = duck.vertices.colwise().minCoeff(), high = duck.vertices.colwise().maxCoeff();
    const double size = (high - low).norm();
    const SegmentGrid grid(duck.vertices, duck.faces, size / 50.0);
    const SegmentGrid one_cell(duck.vertices, duck.faces, 10.0 * size);  // tests every face
    std::mt19937 bits(5);
    const auto point = [&] {
        Vec3 p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] =
                low[axis] + (high[axis] - low[axis]) * static_cast<double>(bits()) / 4294967296.0;
        return p;
    };
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 from = point(), to = point();
        const bool expected = one_cell.hits(from, to);
        EXPECT_EQ(grid.hits(from, to), expected);
        hits += expected;
    }
    EXPECT_GT(hits, 200);
    EXPECT_LT(hits, 1800);
}

}  // namespace cloth::segment_grid_test
