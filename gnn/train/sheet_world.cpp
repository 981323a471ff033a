#include "gnn/train/sheet_world.h"

#include <cmath>
#include <utility>

namespace cloth {

namespace {

/// To and fro along a line, starting at rest.
struct Swing {
    Vec3 amplitude = Vec3::Zero();  ///< (m)
    double frequency = 1.0;         ///< (Hz)
    Vec3 at(double time) const {
        return 0.5 * (1.0 - std::cos(2.0 * M_PI * frequency * time)) * amplitude;
    }
};

struct Ball {
    Vec3 centre;
    double radius;
    Swing swing;
};

class SheetWorld : public TrainingWorld {
 public:
    SheetWorld(Points pins, Swing swing, std::vector<Ball> balls)
        : m_pins(std::move(pins)), m_swing(swing), m_balls(std::move(balls)) {}

    void boundary(double time, double dt, Boundary& out) override {
        out.obstacles.resize(m_balls.size());
        for (size_t k = 0; k < m_balls.size(); ++k) {
            Obstacle& obstacle = out.obstacles[k];
            obstacle.shape = ObstacleShape::sphere;
            obstacle.radius = m_balls[k].radius;
            obstacle.pose0.translation() = m_balls[k].centre + m_balls[k].swing.at(time);
            obstacle.pose1.translation() = m_balls[k].centre + m_balls[k].swing.at(time + dt);
        }
        out.pin_targets = m_pins;
        out.pin_targets.rowwise() += m_swing.at(time + dt).transpose();
    }

 private:
    Points m_pins;
    Swing m_swing;
    std::vector<Ball> m_balls;
};

std::vector<int> choose_pins(const TriMesh& flat, SceneRandom& random) {
    const std::vector<int> corners = sheet_corners(flat);
    const double u = random.uniform();
    if (u < 0.30) return {corners[0], corners[1]};
    if (u < 0.55) return sheet_side(flat, SheetSide::left);
    if (u < 0.70) return corners;
    if (u < 0.80) return {corners[0]};
    return {};
}

Swing random_swing(SceneRandom& random, double reach) {
    const double frequency = random.log_uniform(0.3, 1.5);
    return {random.uniform(0.0, reach) / (1.0 + frequency) * random.direction(), frequency};
}

std::vector<Ball> choose_balls(const Vec3& down, bool held, SceneRandom& random) {
    std::vector<Ball> balls;
    const int count = held ? random.below(3) : 1 + random.below(2);
    for (int k = 0; k < count; ++k) {
        const double radius = random.uniform(0.06, 0.22);
        const double gap = random.uniform(0.01, 0.12);
        const Vec3 aside = 0.15 * random.direction();
        const Vec3 centre = (radius + gap) * down + aside - aside.dot(down) * down;
        Swing swing = random_swing(random, 0.5);
        if (held) swing.amplitude = -(gap + random.uniform(0.0, 0.35)) * down;
        balls.push_back({centre, radius, swing});
    }
    return balls;
}

}  // namespace

SceneParts make_sheet_parts(const TriMesh& flat, const Fabric& fabric, SceneRandom& random) {
    SceneParts parts;
    parts.kind = "sheet";
    const std::vector<int> pins = choose_pins(flat, random);
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(random.uniform(0.0, 2.0 * M_PI), Vec3::UnitY()) *
        Eigen::AngleAxisd(pins.empty() ? random.uniform(-0.4, 0.4) : random.uniform(-1.6, 1.6),
                          Vec3::UnitX());
    auto garment = std::make_shared<Garment>("sheet", flat, fabric, pins);
    parts.start = ClothState::at_rest(*garment);
    parts.start.x = flat.vertices * turn.toRotationMatrix().transpose();
    Points held(static_cast<Eigen::Index>(garment->pins().size()), 3);
    for (size_t k = 0; k < garment->pins().size(); ++k)
        held.row(static_cast<Eigen::Index>(k)) = parts.start.x.row(garment->pins()[k]);
    const Swing swing = random_swing(random, 0.6);
    const Vec3 down = pins.empty() ? Vec3(-Vec3::UnitY()) : Vec3(-(turn * Vec3::UnitY()));
    std::vector<Ball> balls = choose_balls(down, !pins.empty(), random);
    parts.world = std::make_unique<SheetWorld>(held, swing, std::move(balls));
    parts.garment = garment;
    parts.life = 20 + random.below(60);
    return parts;
}

SceneParts make_test_sheet(int vertices, bool held) {
    const TriMesh flat = make_sheet(0.6, 0.6, vertices);
    const std::vector<int> corners = sheet_corners(flat);
    const std::vector<int> pins =
        held ? std::vector<int>{corners[0], corners[1]} : std::vector<int>();
    SceneParts parts;
    parts.kind = "sheet";
    auto garment = std::make_shared<Garment>("sheet", flat, Fabric::soft_cotton(), pins);
    parts.start = ClothState::at_rest(*garment);
    Points targets(static_cast<Eigen::Index>(pins.size()), 3);
    for (Eigen::Index k = 0; k < targets.rows(); ++k)
        targets.row(k) = flat.vertices.row(garment->pins()[static_cast<size_t>(k)]);
    std::vector<Ball> balls;
    if (!held) balls.push_back({Vec3(0.03, -0.2, 0.02), 0.15, {}});
    parts.world = std::make_unique<SheetWorld>(targets, Swing(), std::move(balls));
    parts.garment = garment;
    return parts;
}

}  // namespace cloth
