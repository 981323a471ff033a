// Pins that ask for more than cloth can do.

#include <cmath>

#include "data/authoring/sheet.h"
#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

constexpr int sheet_vertices = 600;

/// A level sheet held by its left and right side, which move so that the distance between them is
/// `width`(t) times that at rest.
HardSceneParts held_by_two_sides(const std::function<double(double)>& width) {
    const TriMesh sheet = level_sheet(sheet_vertices);
    std::vector<int> pins = sheet_side(sheet, SheetSide::left);
    for (const int pin : sheet_side(sheet, SheetSide::right)) pins.push_back(pin);
    Garment garment("sheet", sheet, Fabric::soft_cotton(), pins);
    const ClothState start = ClothState::at_rest(garment);
    const Points held = sheet.vertices(garment.pins(), Eigen::all);
    const auto outside = [held, width](double, double t1) {
        Boundary boundary;
        boundary.pin_targets = held;
        boundary.pin_targets.col(0) *= width(t1);
        return boundary;
    };
    return {std::move(garment), start, outside};
}

}  // namespace

HardSceneParts yanked_corner() {
    constexpr double speed = 20.0, begin = 0.3, end = 0.4;
    const TriMesh sheet = hanging_sheet(sheet_vertices);
    Garment garment("sheet", sheet, Fabric::soft_cotton(),
                    {sheet_corners(level_sheet(sheet_vertices))[0]});
    const ClothState start = ClothState::at_rest(garment);
    const Points held = sheet.vertices(garment.pins(), Eigen::all);
    const auto outside = [=](double, double t1) {
        Boundary boundary;
        const double way = speed * (end - begin) * ramp(t1, begin, end);
        boundary.pin_targets = held;
        boundary.pin_targets.row(0) += way * Vec3(-1.0, 1.0, 0.0).normalized().transpose();
        return boundary;
    };
    return {std::move(garment), start, outside};
}

HardSceneParts stretch_3() {
    return held_by_two_sides(
        [](double time) { return time < 0.9 + 0.01 ? 1.0 + 2.0 * ramp(time, 0.2, 0.7) : 1.0; });
}

HardSceneParts crumple() {
    HardSceneParts parts = held_by_two_sides(
        [](double time) { return 1.0 - 0.95 * (eased(time, 0.1, 0.4) - eased(time, 0.6, 1.0)); });
    // folds need something to begin with; a fixed pattern of 1 mm
    for (Eigen::Index i = 0; i < parts.start.x.rows(); ++i)
        parts.start.x(i, 1) += 1e-3 * std::sin(40.0 * parts.start.x(i, 0) + 1.7 * i);
    return parts;
}

}  // namespace cloth
