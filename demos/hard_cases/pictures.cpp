#include "demos/hard_cases/pictures.h"

#include <algorithm>
#include <memory>

#include "render/montage.h"
#include "render/osmesa_renderer.h"

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

}  // namespace

Image draw_hard_case(const HardScene& scene, const std::vector<int>& frames,
                     const std::vector<HardStrip>& strips) {
    OsmesaSettings size;
    size.width = panel_width;
    size.height = panel_height;
    OsmesaRenderer renderer(size);
    std::vector<Image> panels;
    std::vector<std::string> captions;
    for (size_t row = 0; row < frames.size(); ++row) {
        const Moment moment(scene, frames[row], row, strips);
        for (const HardStrip& strip : strips) {
            panels.push_back(moment.draw(renderer, strip));
            captions.push_back(row == 0 ? strip.caption : "frame " + std::to_string(frames[row]));
        }
    }
    MontageSettings layout;
    layout.columns = static_cast<int>(strips.size());
    layout.caption_height = 20;
    return montage(panels, captions, layout);
}

}  // namespace cloth
