// Obstacles that move fast, or leave cloth nowhere to go.

#include <cmath>

#include "data/authoring/sheet.h"
#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

constexpr int sheet_vertices = 600;

/// A curtain that hangs from its top seam.
Garment curtain() {
    const TriMesh sheet = hanging_sheet(sheet_vertices);
    return {"curtain", sheet, Fabric::soft_cotton(), top_seam(sheet)};
}

Points held_pins(const Garment& garment) {
    return garment.rest().vertices(garment.pins(), Eigen::all);
}

/// Two limbs that close on the curtain from both sides and open again.
/// @param gap    between them when they are closed (m); negative: they sink into each other
/// @param splay  of each from the horizontal (rad): 0 parallel
HardSceneParts pinch(double gap, double splay) {
    constexpr double radius = 0.05, open = 0.1, half = 0.35;
    Garment garment = curtain();
    const ClothState start = ClothState::at_rest(garment);
    const Points pins = held_pins(garment);
    const auto limb = [=](double side, double time) {
        const double shut = eased(time, 0.2, 0.6) - eased(time, 1.2, 1.6);
        const double apart = open + shut * (gap - open);
        Pose pose = placed(Vec3(0.0, 0.0, side * (radius + 0.5 * apart)));
        pose.linear() = (Eigen::AngleAxisd(side * splay, Vec3::UnitY()) *
                         Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ()))
                            .toRotationMatrix();
        // they meet at their ends, as legs do, and not in the middle
        if (splay != 0.0) pose.translation() += pose.linear() * Vec3(0.0, half, 0.0);
        return pose;
    };
    const auto outside = [=](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets = pins;
        for (const double side : {-1.0, 1.0})
            boundary.obstacles.push_back(capsule(radius, half, limb(side, t0), limb(side, t1)));
        return boundary;
    };
    return {std::move(garment), start, outside};
}

}  // namespace

HardSceneParts hands_through_shirt() {
    constexpr double radius = 0.02, half = 0.25, reach = 0.3, speed = 2.0;
    Garment garment = curtain();
    const ClothState start = ClothState::at_rest(garment);
    const Points pins = held_pins(garment);
    const auto hand = [=](double time) {
        const double there = reach * ramp(time, 0.3, 0.3 + reach / speed);
        const double back = reach * ramp(time, 1.0, 1.0 + reach / speed);
        return turned_about_x(Vec3(0.0, 0.0, half + radius + 0.05 - there + back), 0.5 * M_PI);
    };
    const auto outside = [=](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets = pins;
        boundary.obstacles.push_back(capsule(radius, half, hand(t0), hand(t1)));
        return boundary;
    };
    return {std::move(garment), start, outside};
}

HardSceneParts fast_ball() {
    constexpr double radius = 0.08, speed = 10.0, from = 0.5, to = -0.15;
    Garment garment = curtain();
    const ClothState start = ClothState::at_rest(garment);
    const Points pins = held_pins(garment);
    const auto centre = [=](double time) {
        const double flown = ramp(time, 0.3, 0.3 + (from - to) / speed);
        return Vec3(0.0, 0.0, from + (to - from) * flown);
    };
    const auto outside = [=](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets = pins;
        boundary.obstacles.push_back(ball(radius, centre(t0), centre(t1)));
        return boundary;
    };
    HardSceneParts parts{std::move(garment), start, outside};
    parts.loss = [=](const Boundary& boundary, const Points& x) {
        const double front = boundary.obstacles[0].pose1.translation().z() - radius;
        const bool pushed = front < -0.02;
        return pushed && x.col(2).minCoeff() > front + 0.02 ? "the ball went through" : "";
    };
    return parts;
}

HardSceneParts teleport() {
    constexpr double jump_time = 0.5, jump = 1.0;
    constexpr double radius = 0.12, half = 0.3, back = 0.16;
    Garment garment = curtain();
    const ClothState start = ClothState::at_rest(garment);
    const Points pins = held_pins(garment);
    // half a frame off, so that rounding does not decide which frame jumps
    const auto moved = [=](double time) { return time > jump_time + 0.01 ? jump : 0.0; };
    const auto outside = [=](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets = pins;
        boundary.pin_targets.col(2).array() += moved(t1);
        boundary.obstacles.push_back(capsule(radius, half, placed(Vec3(0, 0, moved(t0) - back)),
                                             placed(Vec3(0, 0, moved(t1) - back))));
        return boundary;
    };
    return {std::move(garment), start, outside};
}

HardSceneParts dress_12000() {
    constexpr double radius = 0.25, drop = 0.05;
    Garment garment("dress", make_sheet(1.5, 1.5, 12000), Fabric::soft_cotton());
    const ClothState start = ClothState::at_rest(garment);
    const auto outside = [=](double, double) {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        const Vec3 centre(0.0, -radius - drop, 0.0);
        boundary.obstacles.push_back(ball(radius, centre, centre));
        return boundary;
    };
    HardSceneParts parts{std::move(garment), start, outside};
    parts.loss = [=](const Boundary&, const Points& x) {
        return x.col(1).maxCoeff() < -drop - radius ? "fell off or through the ball" : "";
    };
    return parts;
}

HardSceneParts armpit_pinch() {
    return pinch(/*gap=*/1e-3, /*splay=*/0.0);
}

HardSceneParts crotch_pinch() {
    return pinch(/*gap=*/-6e-3, /*splay=*/0.2);
}

HardSceneParts closing_boxes() {
    constexpr double open = 0.2, gap = 2e-3, pull = 0.3;
    const Vec3 half(0.1, 0.05, 0.4);
    const TriMesh sheet = level_sheet(sheet_vertices);
    Garment garment("sheet", sheet, Fabric::soft_cotton(), sheet_side(sheet, SheetSide::left));
    const ClothState start = ClothState::at_rest(garment);
    const Points pins = held_pins(garment);
    const auto apart = [=](double time) { return open + eased(time, 0.0, 0.3) * (gap - open); };
    const auto outside = [=](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets = pins;
        boundary.pin_targets.col(0).array() -= pull * ramp(t1, 0.5, 1.1);
        for (const double side : {-1.0, 1.0}) {
            const auto centre = [&](double time) {
                return Vec3(0.1, side * (half.y() + 0.5 * apart(time)), 0.0);
            };
            boundary.obstacles.push_back(box(half, centre(t0), centre(t1)));
        }
        return boundary;
    };
    return {std::move(garment), start, outside};
}

}  // namespace cloth
