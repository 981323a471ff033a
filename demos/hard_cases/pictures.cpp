#include "demos/hard_cases/pictures.h"

#include <algorithm>
#include <memory>

#include "render/montage.h"
#include "render/osmesa_renderer.h"
#include "render/video.h"

namespace cloth {
namespace {

constexpr int panel_width = 300, panel_height = 320;  // (pixels)
constexpr double widest_garment = 4.0;  // what is larger (m) has exploded and leads no camera

double extent(const Points& x) {
    return (x.colwise().maxCoeff() - x.colwise().minCoeff()).maxCoeff();
}

Points stacked(const Points& a, const Points& b) {
    Points all(a.rows() + b.rows(), 3);
    all << a, b;
    return all;
}

SceneMesh body_mesh(const TriMesh& surface) {
    SceneMesh mesh;
    mesh.vertices = surface.vertices;
    mesh.faces = std::make_shared<Faces>(surface.faces);
    mesh.colour = {222, 190, 170};
    return mesh;
}

SceneMesh garment_mesh(const Points& x, const std::shared_ptr<const Faces>& faces) {
    SceneMesh mesh;
    mesh.vertices = x;
    mesh.faces = faces;
    mesh.colour = {86, 132, 196};
    mesh.back_colour = {196, 112, 72};
    mesh.two_sided = true;
    mesh.gloss = 0.0;
    return mesh;
}

/// One row: a moment of the scene, the same for all solvers.
class Moment {
 public:
    Moment(const HardScene& scene, int frame, size_t index, const std::vector<HardStrip>& strips)
        : m_index(index), m_faces(std::make_shared<Faces>(scene.garment().rest().faces)) {
        const Boundary outside = scene.boundary_of_frame(frame);
        Points seen = outside.pin_targets;
        for (const Obstacle& obstacle : outside.obstacles) {
            m_bodies.push_back(surface_of(obstacle));
            seen = stacked(seen, m_bodies.back().vertices);
        }
        for (const HardStrip& strip : strips)
            if (index < strip.x.size() && extent(strip.x[index]) < widest_garment) {
                seen = stacked(seen, strip.x[index]);
                break;
            }
        if (seen.rows() == 0) seen = scene.start().x;
        m_centre = seen.colwise().mean();
        FigureTracker tracker(FramingSettings{}, static_cast<double>(panel_width) / panel_height);
        m_camera = tracker.follow(seen.rowwise() - m_centre);
    }

    Image draw(OsmesaRenderer& renderer, const HardStrip& strip) const {
        Scene scene;
        scene.ground.visible = false;
        for (TriMesh body : m_bodies) {
            body.vertices.rowwise() -= m_centre;
            scene.meshes.push_back(body_mesh(body));
        }
        if (m_index < strip.x.size())
            scene.meshes.push_back(garment_mesh(strip.x[m_index].rowwise() - m_centre, m_faces));
        return renderer.render(scene, m_camera);
    }

 private:
    size_t m_index;
    std::shared_ptr<const Faces> m_faces;
    std::vector<TriMesh> m_bodies;
    Eigen::RowVector3d m_centre;  ///< drawn at the origin: the renderer leaves out what is far away
    Camera m_camera;
};

/// Draws rows of panels with one renderer.
class RowPainter {
 public:
    RowPainter(const HardScene& scene, const std::vector<HardStrip>& strips)
        : m_scene(scene), m_strips(strips), m_renderer(panel_size()) {
        m_layout.columns = static_cast<int>(strips.size());
        m_layout.caption_height = 20;
    }

    /// Adds the panels of a frame, which is the strips' index-th.
    void add(int frame, size_t index) {
        const Moment moment(m_scene, frame, index, m_strips);
        const bool first = m_panels.empty();
        for (const HardStrip& strip : m_strips) {
            m_panels.push_back(moment.draw(m_renderer, strip));
            m_captions.push_back(first ? strip.caption : "frame " + std::to_string(frame));
        }
    }

    /// All panels since the last take().
    Image take() {
        const Image image = montage(m_panels, m_captions, m_layout);
        m_panels.clear();
        m_captions.clear();
        return image;
    }

 private:
    static OsmesaSettings panel_size() {
        OsmesaSettings size;
        size.width = panel_width;
        size.height = panel_height;
        return size;
    }

    const HardScene& m_scene;
    const std::vector<HardStrip>& m_strips;
    OsmesaRenderer m_renderer;
    MontageSettings m_layout;
    std::vector<Image> m_panels;
    std::vector<std::string> m_captions;
};

}  // namespace

Image draw_hard_case(const HardScene& scene, const std::vector<int>& frames,
                     const std::vector<int>& rows, const std::vector<HardStrip>& strips) {
    RowPainter painter(scene, strips);
    for (size_t k = 0; k < frames.size(); ++k)
        if (std::count(rows.begin(), rows.end(), frames[k]) > 0) painter.add(frames[k], k);
    return painter.take();
}

void film_hard_case(const std::string& path, const HardScene& scene, const std::vector<int>& frames,
                    const std::vector<HardStrip>& strips) {
    RowPainter painter(scene, strips);
    std::unique_ptr<VideoWriter> video;
    for (size_t k = 0; k < frames.size(); ++k) {
        painter.add(frames[k], k);
        const Image image = painter.take();
        VideoSettings settings;
        settings.fps = 1.0 / scene.dt();
        if (!video)
            video = std::make_unique<VideoWriter>(path, image.width(), image.height(), settings);
        video->add(image);
    }
    if (video) video->close();
}

}  // namespace cloth
