#include "demos/import_garment/picture.h"

#include <memory>

#include "demos/compare/figure_meshes.h"
#include "render/montage.h"
#include "render/osmesa_renderer.h"

namespace cloth {
namespace {

constexpr int panel_width = 400, panel_height = 640;  // (pixels)

Scene scene_of(const TriMesh& skin) {
    Scene scene;
    scene.meshes.push_back(skin_mesh(skin.vertices, std::make_shared<const Faces>(skin.faces)));
    scene.ground.height = skin.vertices.col(1).minCoeff();
    scene.ground.centre = skin.vertices.colwise().mean().transpose();
    return scene;
}

Camera camera_from(const Vec3& direction, const Points& figure) {
    FramingSettings framing;
    framing.direction = direction;
    return FigureTracker(framing, static_cast<double>(panel_width) / panel_height).follow(figure);
}

}  // namespace

Image import_picture(const GarmentImport& import, const TriMesh& skin) {
    Scene before = scene_of(skin), after = before;
    before.meshes.push_back(
        garment_mesh(import.read.vertices, std::make_shared<const Faces>(import.read.faces), 7));
    for (size_t k = 0; k < import.garments.size(); ++k) {
        const TriMesh& worn = import.garments[k].worn;
        after.meshes.push_back(
            garment_mesh(worn.vertices, std::make_shared<const Faces>(worn.faces), k));
    }
    OsmesaSettings settings;
    settings.width = panel_width;
    settings.height = panel_height;
    OsmesaRenderer renderer(settings);
    const Camera front = camera_from({-0.45, -0.12, -1.0}, skin.vertices);
    const Camera back = camera_from({0.45, -0.12, 1.0}, skin.vertices);
    MontageSettings row;
    row.columns = 4;
    return montage({renderer.render(before, front), renderer.render(after, front),
                    renderer.render(before, back), renderer.render(after, back)},
                   {"before", "after", "before", "after"}, row);
}

}  // namespace cloth
