#include "render/camera.h"
#include "render/montage.h"
#include "render/osmesa_renderer.h"
#include "render/plot.h"
#include "render/video.h"
#include "tests/ranges.h"

namespace cloth::test {
namespace {

TEST(SettingsRanges, Camera) {
    const auto use = [](const Camera& camera) { projection_matrix(camera, 1.0); };
    expect_range("Camera.fov_y_deg", &Camera::fov_y_deg, 5.0, 120.0, use);
    expect_range("Camera.near_plane", 1e-6, 1e6, [&](double value) {
        Camera camera;
        camera.near_plane = value;
        camera.far_plane = 2e6;
        use(camera);
    });
    expect_range("Camera.far_plane", &Camera::far_plane, 1.001 * Camera().near_plane, 1e9, use);
}

TEST(SettingsRanges, Framing) {
    using S = FramingSettings;
    const auto use = [](const S& settings) { FigureTracker(settings, 1.0); };
    expect_range("FramingSettings.fov_y_deg", &S::fov_y_deg, 5.0, 120.0, use);
    expect_range("FramingSettings.margin", &S::margin, 0.0, 0.2, use);
    expect_range("FramingSettings.dead_zone", &S::dead_zone, 0.0, 0.2, use);
    expect_range("FramingSettings.smoothing", &S::smoothing, 0.0, 1.0, use);
}

TEST(SettingsRanges, Montage) {
    using S = MontageSettings;
    const auto use = [](const S& settings) { montage({Image(4, 4)}, {}, settings); };
    expect_range("MontageSettings.columns", &S::columns, 0, 1000, use);
    expect_range("MontageSettings.gap", &S::gap, 0, 200, use);
    expect_range("MontageSettings.caption_height", &S::caption_height, 8, 200, use);
}

TEST(SettingsRanges, Renderer) {
    using S = OsmesaSettings;
    const auto use = [](const S& settings) { OsmesaRenderer{settings}; };
    expect_range("OsmesaSettings.width", &S::width, 16, 4096, use);
    expect_range("OsmesaSettings.height", &S::height, 16, 4096, use);
    expect_range("OsmesaSettings.shadow_size", &S::shadow_size, 64, 4096, use);
}

TEST(SettingsRanges, Scene) {
    OsmesaRenderer renderer({16, 16, 64, false});
    const auto ground = [&](const Ground& part) {
        Scene scene;
        scene.ground = part;
        renderer.render(scene, Camera());
    };
    expect_range("Ground.height", &Ground::height, -1000.0, 1000.0, ground);
    expect_range("Ground.grid", &Ground::grid, 0.01, 100.0, ground);
    expect_range("Ground.radius", &Ground::radius, 0.1, 1000.0, ground);
    const auto lights = [&](const Lights& part) {
        Scene scene;
        scene.lights = part;
        renderer.render(scene, Camera());
    };
    expect_range("Lights.key_strength", &Lights::key_strength, 0.0, 10.0, lights);
    expect_range("Lights.fill_strength", &Lights::fill_strength, 0.0, 10.0, lights);
    expect_range("Lights.ambient_sky", &Lights::ambient_sky, 0.0, 10.0, lights);
    expect_range("Lights.ambient_ground", &Lights::ambient_ground, 0.0, 10.0, lights);
    const auto mesh = [&](SceneMesh part) {
        part.vertices = Points::Zero(3, 3);
        part.faces = std::make_shared<const Faces>(Faces{{0, 1, 2}});
        Scene scene;
        scene.meshes = {part};
        renderer.render(scene, Camera());
    };
    expect_range("SceneMesh.gloss", &SceneMesh::gloss, 0.0, 1.0, mesh);
    expect_range("SceneMesh.depth_offset", &SceneMesh::depth_offset, 0.0, 1.0, mesh);
}

TEST(SettingsRanges, Plot) {
    using S = PlotSettings;
    const auto use = [](const S& settings) { plot_svg({{"a", {0, 1}, {1, 2}}}, settings); };
    expect_range("PlotSettings.width", &S::width, 200, 4000, use);
    expect_range("PlotSettings.height", &S::height, 120, 4000, use);
}

TEST(SettingsRanges, Video) {
    using S = VideoSettings;
    const std::string path = testing::TempDir() + "ranges.mp4";
    const auto use = [&](const S& settings) { VideoWriter(path, 16, 16, settings); };
    expect_range("VideoSettings.fps", &S::fps, 1.0, 240.0, use);
    expect_range("VideoSettings.quality", &S::quality, 0, 51, use);
    expect_range("VideoSettings.key_frame_interval", &S::key_frame_interval, 1, 600, use);
}

}  // namespace
}  // namespace cloth::test
