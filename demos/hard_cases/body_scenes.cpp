// A garment on a body of many triangles.

#include <cmath>
#include <memory>

#include "data/body/body.h"
#include "data/files/garment_assets.h"
#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

/// Degrees that the body has turned: a third of a second at rest, half a second of speeding up,
/// then 720 degrees/s.
double turned(double time) {
    constexpr double begin = 1.0 / 3.0, speeding_up = 0.5, speed = 720.0;
    const double t = time - begin;
    if (t <= 0.0) return 0.0;
    if (t < speeding_up) return 0.5 * speed / speeding_up * t * t;
    return speed * (t - 0.5 * speeding_up);
}

Points spun(const Points& rest, double time) {
    const Eigen::AngleAxisd turn(turned(time) * M_PI / 180.0, Vec3::UnitY());
    return rest * turn.toRotationMatrix().transpose();
}

}  // namespace

HardSceneParts body_spin() {
    const auto body = std::make_shared<const Body>(Body::load_default());
    Garment garment = load_garment("tshirt_1000");
    const ClothState start = ClothState::at_rest(garment);
    const auto outside = [body](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        Obstacle skin;
        skin.faces = body->faces();
        skin.x0 = spun(body->rest(), t0);
        skin.x1 = spun(body->rest(), t1);
        boundary.obstacles.push_back(std::move(skin));
        return boundary;
    };
    HardSceneParts parts{std::move(garment), start, outside};
    parts.segments = segment_body(body->rest_mesh(), body->dominant_joint());
    return parts;
}

}  // namespace cloth
