#include "demos/speed_error/scenes.h"

#include <algorithm>
#include <cmath>

#include "data/authoring/sheet.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_scene.h"

namespace cloth {
namespace {

constexpr double sheet_size = 1.0;  // edge of the sheets (m)
constexpr int sheet_seconds = 3;    // what 0 frames mean without a motion that ends

/// A sheet held by a clip at each of two corners, level at first: it swings down.
class SheetScene : public ComparisonScene {
 public:
    explicit SheetScene(const SceneSettings& settings)
        : ComparisonScene(make_garment(settings), settings.rate) {
        const int frames = settings.frames == 0 ? sheet_seconds * rate() : settings.frames;
        set_length(frames, frames);
        const std::vector<int>& pins = garment().pins();
        m_held.resize(static_cast<Eigen::Index>(pins.size()), 3);
        for (size_t p = 0; p < pins.size(); ++p)
            m_held.row(static_cast<Eigen::Index>(p)) = garment().rest().vertices.row(pins[p]);
    }

    Boundary boundary(double, double) const override {
        Boundary boundary;
        boundary.pin_targets = m_held;
        return boundary;
    }

 private:
    /// A single vertex would hold a weight of 1 N by a few edges, which no fabric bears.
    static constexpr double clip_radius = 0.05;  // (m)

    static Garment make_garment(const SceneSettings& settings) {
        const TriMesh sheet = make_sheet(sheet_size, sheet_size, settings.vertices);
        const std::vector<int> corners = sheet_corners(sheet);
        std::vector<int> pins = {corners[0], corners[1]};
        for (int v = 0; v < sheet.vertices.rows(); ++v)
            for (int c = 0; c < 2; ++c)
                if ((sheet.vertices.row(v) - sheet.vertices.row(corners[c])).norm() < clip_radius)
                    pins.push_back(v);
        std::sort(pins.begin(), pins.end());
        pins.erase(std::unique(pins.begin(), pins.end()), pins.end());
        return {"sheet", sheet, fabric_named(settings.fabric), pins};
    }

    Points m_held;  ///< |pins| x 3
};

/// A level sheet that falls on a sphere, which moves to and fro sideways.
class SphereScene : public ComparisonScene {
 public:
    explicit SphereScene(const SceneSettings& settings)
        : ComparisonScene({"sheet", make_sheet(sheet_size, sheet_size, settings.vertices),
                           fabric_named(settings.fabric)},
                          settings.rate) {
        const int frames = settings.frames == 0 ? sheet_seconds * rate() : settings.frames;
        set_length(frames, frames);
    }

    Boundary boundary(double t0, double t1) const override {
        Obstacle sphere;
        sphere.shape = ObstacleShape::sphere;
        sphere.radius = radius;
        sphere.pose0.translation() = centre(t0);
        sphere.pose1.translation() = centre(t1);
        Boundary boundary;
        boundary.obstacles.push_back(sphere);
        return boundary;
    }

 private:
    static constexpr double radius = 0.25;    // (m)
    static constexpr double gap = 0.05;       // between sheet and sphere at first (m)
    static constexpr double amplitude = 0.1;  // of the sphere's motion, from one end to the other
    static constexpr double frequency = 0.5;  // of the sphere's motion (Hz)

    static Vec3 centre(double time) {
        const double swing = 0.5 * (1.0 - std::cos(2.0 * M_PI * frequency * time));
        return {amplitude * swing, -radius - gap, 0.0};
    }
};

}  // namespace

std::vector<std::string> scene_names() {
    return {"sheet", "tshirt", "sphere"};
}

std::string scene_description(const std::string& name) {
    if (name == "sheet") return "a level sheet of 1 m, held at two corners, swings down";
    if (name == "sphere") return "a sheet of 1 m falls on a sphere of 0.25 m that moves sideways";
    return (name == "tshirt" ? "a T-shirt" : name) + " on a body, motion 01_01";
}

std::unique_ptr<ComparisonScene> make_scene(const SceneSettings& settings) {
    if (settings.name == "sheet") return std::make_unique<SheetScene>(settings);
    if (settings.name == "sphere") return std::make_unique<SphereScene>(settings);
    BodySceneSettings body;
    body.garment = settings.name;
    body.body = settings.body;
    body.motion = settings.motion;
    body.fabric = settings.fabric;
    body.rate = settings.rate;
    body.frames = settings.frames;
    body.reference_frames = settings.frames;
    body.limbs = settings.limbs;
    return std::make_unique<BodyScene>(body);
}

}  // namespace cloth
