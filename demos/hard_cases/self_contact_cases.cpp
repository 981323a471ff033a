// Cloth that meets itself, or other cloth.

#include <cmath>

#include "data/authoring/sheet.h"
#include "data/core/garment_pieces.h"
#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

constexpr int sheet_vertices = 400;
constexpr double thickness = 4e-3;  // m

HardSceneParts with_self_contact(HardSceneParts parts) {
    parts.self_contact.thickness = thickness;
    return parts;
}

}  // namespace

HardSceneParts falls_on_edge() {
    Garment garment("sheet", hanging_sheet(sheet_vertices), Fabric::soft_cotton());
    ClothState start = ClothState::at_rest(garment);
    // Straight cloth would stand on its edge: it leans, and has a wave to begin with.
    for (Eigen::Index i = 0; i < start.x.rows(); ++i)
        start.x(i, 2) += 0.02 * start.x(i, 1) + 5e-3 * std::sin(15.0 * start.x(i, 1)) +
                         3e-3 * std::sin(20.0 * start.x(i, 0));
    const double bottom = start.x.col(1).minCoeff();
    const auto outside = [bottom](double, double) {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        const Vec3 centre(0.0, bottom - 0.1, 0.0);
        boundary.obstacles.push_back(box(Vec3(0.5, 0.05, 0.5), centre, centre));
        return boundary;
    };
    return with_self_contact({std::move(garment), std::move(start), outside});
}

HardSceneParts two_layers() {
    constexpr double radius = 0.15, drop = 0.05;
    TriMesh above = make_sheet(0.3, 0.3, sheet_vertices / 2, 2);
    above.vertices.col(1).array() += drop;
    Garment garment =
        merge_garments("two layers",
                       {Garment("below", level_sheet(sheet_vertices), Fabric::soft_cotton()),
                        Garment("above", above, Fabric::soft_cotton())})
            .garment;
    ClothState start = ClothState::at_rest(garment);
    const auto outside = [=](double, double) {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        const Vec3 centre(0.0, -radius - 0.01, 0.0);
        boundary.obstacles.push_back(ball(radius, centre, centre));
        return boundary;
    };
    return with_self_contact({std::move(garment), std::move(start), outside});
}

}  // namespace cloth
