// The sheet that swings onto a moving ball: one scene, varied by its settings.

#include <cmath>

#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

constexpr double ball_radius = 0.12;  // (m)

/// Under the sheet, from where it stands when the sheet comes down and back.
Vec3 ball_centre(double time, double rise) {
    constexpr double travel = 0.25, frequency = 0.7;
    const double way = 0.5 * travel * (1.0 - std::cos(2.0 * M_PI * frequency * time));
    return {0.0, -0.35 + rise * eased(time, 0.0, 1.0), -0.05 - way};
}

/// Two clips at the back corners of what there is of a sheet.
std::vector<int> back_clips(const TriMesh& level) {
    const VectorX left = (level.vertices.col(0) + level.vertices.col(2)).eval();
    const VectorX right = (level.vertices.col(2) - level.vertices.col(0)).eval();
    Eigen::Index a = 0, b = 0;
    left.minCoeff(&a);
    right.minCoeff(&b);
    return clipped(level, {level.vertices.row(a).transpose(), level.vertices.row(b).transpose()});
}

}  // namespace

HardSceneParts swing(const TriMesh& level, const SwingSettings& settings) {
    const Pose place = settings.place;
    const double rise = settings.ball_rise;
    Garment garment("sheet", level, settings.fabric, back_clips(level));
    ClothState start = ClothState::at_rest(garment);
    start.x = transformed(start.x, place);
    const Points pins = start.x(garment.pins(), Eigen::all);
    const Vec3 gravity = place.linear() * Vec3(0.0, -settings.gravity, 0.0);
    const auto outside = [=](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets = pins;
        boundary.gravity = gravity;
        boundary.obstacles.push_back(
            ball(ball_radius, place * ball_centre(t0, rise), place * ball_centre(t1, rise)));
        return boundary;
    };
    HardSceneParts parts{std::move(garment), start, outside};
    parts.dt = settings.dt;
    return parts;
}

HardSceneParts swing(const SwingSettings& settings) {
    return swing(level_sheet(600), settings);
}

}  // namespace cloth
