#include "gnn/physics/energy/element_block.h"

#include <gtest/gtest.h>

#include <vector>

namespace cloth::element_block_test {
namespace {

constexpr int vertices = 7, corners = 4, most = 11;

/// Corners of elements that share vertices; the last vertex is among them.
std::vector<int> some_elements() {
    std::vector<int> indices;
    for (int k = 0; k < most * corners; ++k) indices.push_back((k * k + 3 * k) % vertices);
    indices[5] = vertices - 1;
    return indices;
}

std::vector<double> some_points() {
    std::vector<double> points;
    for (int k = 0; k < 3 * vertices; ++k) points.push_back(1.0 / (k + 3.0));
    return points;
}

}  // namespace

TEST(ElementBlock, ReadsTheCornersOfAnyNumberOfElements) {
    const std::vector<int> indices = some_elements();
    const std::vector<double> points = some_points();
    for (int first = 0; first < 2; ++first)
        for (int count = 1; first + count <= most; ++count) {
            ElementBlock<corners> block;
            block.gather(points.data(), indices.data(), first, count);
            for (int e = 0; e < count; ++e)
                for (int k = 0; k < 3 * corners; ++k)
                    EXPECT_EQ(block.x[k][e],
                              points[static_cast<size_t>(
                                  3 * indices[static_cast<size_t>(corners * (first + e) + k / 3)] +
                                  k % 3)]);
        }
}

TEST(ElementBlock, AddsGradientsInTheOrderOfElementsAndCorners) {
    const std::vector<int> indices = some_elements();
    for (int first = 0; first < 2; ++first)
        for (int count = 1; first + count <= most; ++count) {
            ElementBlock<corners> block;
            for (int k = 0; k < 3 * corners; ++k)
                for (int e = 0; e < count; ++e) block.x[k][e] = 1.0 / (1.0 + k + 0.37 * e);
            std::vector<double> sums = some_points(), expected = sums;
            block.scatter(sums.data(), indices.data(), first, count);
            for (int e = 0; e < count; ++e)
                for (int k = 0; k < 3 * corners; ++k)
                    expected[static_cast<size_t>(
                        3 * indices[static_cast<size_t>(corners * (first + e) + k / 3)] + k % 3)] +=
                        block.x[k][e];
            EXPECT_EQ(sums, expected) << "equal bits; " << count << " from " << first;
        }
}

}  // namespace cloth::element_block_test
