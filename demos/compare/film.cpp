#include "demos/compare/film.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "demos/compare/figure_meshes.h"
#include "render/montage.h"
#include "render/osmesa_renderer.h"
#include "render/video.h"

namespace cloth {
namespace {

constexpr int panel_width = 400;
constexpr int panel_height = 560;
constexpr int key_frame_count = 6;

std::string format(const char* pattern, double value) {
    char text[64];
    std::snprintf(text, sizeof(text), pattern, value);
    return text;
}

/// Value of a per-frame series, or null.
nlohmann::json at(const FilmPanel& panel, const char* series, size_t frame) {
    const auto& values = panel.measurement->at("series").at(series);
    return frame < values.size() ? values[frame] : nlohmann::json();
}

std::string caption(const FilmPanel& panel, size_t frame) {
    const auto& ms = panel.measurement->at("ms_per_frame").at("median");
    std::string text = panel.name + "\n";
    text += ms.is_null() ? "no frame" : format("%.1f ms per frame", ms.get<double>());
    const auto error = at(panel, "rmse_mm", frame);
    if (!error.is_null()) text += format("\noff by %.1f mm", error.get<double>());
    const auto depth = at(panel, "penetration_mm", frame);
    if (!depth.is_null() && depth.get<double>() > 1.0)
        text += format("\n%.0f mm inside the body", depth.get<double>());
    if (frame + 1 >= panel.trajectory->size())
        text += panel.measurement->at("finite").get<bool>() ? "\nnot computed so far" : "\nfailed";
    return text;
}

class FilmStudio {
 public:
    FilmStudio(const BodyScene& scene)
        : m_scene(scene),
          m_renderer(settings()),
          m_tracker(FramingSettings{}, static_cast<double>(panel_width) / panel_height),
          m_cloth_faces(std::make_shared<Faces>(scene.garment().rest().faces)) {}

    Image draw(const std::vector<FilmPanel>& panels, size_t frame) {
        const Points skin = m_scene.skin(static_cast<double>(frame + 1) * m_scene.frame_time());
        const Camera camera = m_tracker.follow(skin);
        std::vector<Image> pictures;
        for (size_t k = 0; k < panels.size(); ++k)
            pictures.push_back(m_renderer.render(panel(panels[k], k, frame, skin), camera));
        return montage(pictures);
    }

 private:
    static OsmesaSettings settings() {
        OsmesaSettings settings;
        settings.width = panel_width;
        settings.height = panel_height;
        return settings;
    }

    Scene panel(const FilmPanel& film, size_t index, size_t frame, const Points& skin) const {
        Scene scene;
        scene.meshes.push_back(skin_mesh(skin, m_scene.body().faces()));
        if (frame + 1 < film.trajectory->size())
            scene.meshes.push_back(
                garment_mesh((*film.trajectory)[frame + 1].x, m_cloth_faces, index));
        Label label;
        label.text = caption(film, frame);
        label.text_height = 20;
        label.corner = LabelCorner::bottom_left;
        scene.labels.push_back(label);
        scene.ground.centre = skin.colwise().mean().transpose();
        return scene;
    }

    const BodyScene& m_scene;
    OsmesaRenderer m_renderer;
    FigureTracker m_tracker;
    std::shared_ptr<const Faces> m_cloth_faces;
};

}  // namespace

std::vector<std::string> make_film(const BodyScene& scene, const std::vector<FilmPanel>& panels,
                                   const std::string& out, const ProgressFunction& progress) {
    FilmStudio studio(scene);
    VideoSettings settings;
    settings.fps = scene.rate();
    std::unique_ptr<VideoWriter> video;
    std::vector<std::string> key_frames;
    const int frames = scene.frames();
    for (int frame = 0; frame < frames; ++frame) {
        const Image image = studio.draw(panels, static_cast<size_t>(frame));
        if (!video)
            video = std::make_unique<VideoWriter>(out + "/comparison.mp4", image.width(),
                                                  image.height(), settings);
        video->add(image);
        const int next_key =
            static_cast<int>(key_frames.size()) * (frames - 1) / std::max(1, key_frame_count - 1);
        if (frame == next_key) {
            key_frames.push_back(out + "/key_frame_" + std::to_string(frame) + ".png");
            write_png(key_frames.back(), image);
        }
        progress(frame + 1, frames, "video");
    }
    if (video) video->close();
    return key_frames;
}

}  // namespace cloth
