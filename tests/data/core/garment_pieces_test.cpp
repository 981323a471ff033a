#include "data/core/garment_pieces.h"

#include <gtest/gtest.h>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"

namespace cloth::garment_pieces_test {
namespace {

Garment piece(int vertices, std::vector<int> pins = {}, Fabric fabric = Fabric::soft_cotton()) {
    return Garment("piece of " + std::to_string(vertices), make_sheet(1.0, 1.0, vertices), fabric,
                   std::move(pins));
}

}  // namespace

TEST(MergeGarments, KeepsVerticesFacesAndPinsOfEach) {
    const Garment first = piece(50, {3}), second = piece(80, {0, 7});
    const MergedGarments merged = merge_garments("both", {first, second});
    EXPECT_EQ(merged.first_vertex, (std::vector<int>{0, 50, 130}));
    EXPECT_EQ(merged.garment.pins(), (std::vector<int>{3, 50, 57}));
    EXPECT_EQ(merged.garment.rest().vertices.bottomRows(80), second.rest().vertices);
    EXPECT_EQ(merged.garment.rest().faces.bottomRows(second.face_count()),
              (second.rest().faces.array() + 50).matrix());
    EXPECT_DOUBLE_EQ(merged.garment.masses().sum(), first.masses().sum() + second.masses().sum());
    EXPECT_EQ(merged.garment.edges().size(), first.edges().size() + second.edges().size());
}

TEST(MergeGarments, RefusesNoneAndWhatOneGarmentCannotHold) {
    EXPECT_THROW(merge_garments("none", {}), ArgumentError);
    try {
        merge_garments("mixed", {piece(50), piece(80, {}, Fabric::real_cotton())});
        FAIL() << "took two fabrics";
    } catch (const ArgumentError& error) {
        EXPECT_NE(std::string(error.what()).find("piece of 80"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("with_fabric"), std::string::npos);
    }
    const Garment folded("folded", make_sheet(1.0, 1.0, 50), Fabric::soft_cotton(), {}, true);
    EXPECT_THROW(merge_garments("mixed", {piece(50), folded}), ArgumentError);
}

TEST(GarmentPieces, AreNumberedInTheOrderOfTheirVertices) {
    const MergedGarments merged = merge_garments("three", {piece(50), piece(30), piece(20)});
    const std::vector<int> pieces = garment_pieces(merged.garment);
    for (int v = 0; v < 100; ++v)
        EXPECT_EQ(pieces[static_cast<size_t>(v)], v < 50 ? 0 : v < 80 ? 1 : 2);
}

}  // namespace cloth::garment_pieces_test
