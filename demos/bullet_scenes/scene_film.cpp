#include "demos/bullet_scenes/scene_film.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "bullet_ext/bulletTypes.h"
#include "render/montage.h"
#include "render/osmesa_renderer.h"
#include "render/video.h"

namespace cloth {

namespace {

constexpr int kWidth = 560, kHeight = 480;  // of a panel (pixels)
const Rgb kRigid = {214, 190, 160}, kOther = {92, 160, 96};
const Rgb kCloth[] = {{196, 84, 72}, {86, 132, 196}, {140, 102, 176}};

SceneMesh surface(const TriMesh& mesh, Rgb colour, bool two_sided) {
    SceneMesh drawn;
    drawn.vertices = mesh.vertices;
    drawn.faces = std::make_shared<const Faces>(mesh.faces);
    drawn.colour = colour;
    drawn.back_colour = back_of(colour);
    drawn.two_sided = two_sided;
    drawn.gloss = two_sided ? 0.0 : 0.15;
    drawn.depth_offset = two_sided ? 0.0 : 0.004;  // facets do not shine through thin cloth
    return drawn;
}

/// The floor with its grid is at height 0: a scene whose ground is lower has one of its own.
bool isOnFloor(const ScenePicture& picture) {
    constexpr double kBelow = -1.0;  // m
    return std::none_of(picture.rigid.begin(), picture.rigid.end(), [](const TriMesh& mesh) {
        return mesh.vertices.rows() > 0 && mesh.vertices.col(1).minCoeff() < kBelow;
    });
}

std::string caption(const SceneRow& row) {
    char text[160];
    const std::string length =
        row.rate_hz > 0 ? "of 1/" + std::to_string(row.rate_hz) + " s" : "of random length";
    std::snprintf(text, sizeof text, "%s\n%.1f ms per step %s", row.solver.c_str(), row.ms_median,
                  length.c_str());
    return text;
}

Image panel(const SceneRecipe& recipe, const SceneResult& run, size_t frame, Rgb colour,
            OsmesaRenderer& renderer) {
    Scene scene;
    scene.labels.push_back({caption(run.row) + (frame < run.pictures.size() ? "" : "\nfailed"),
                            LabelCorner::bottom_left, 20});
    if (frame < run.pictures.size()) {
        const ScenePicture& picture = run.pictures[frame];
        for (const TriMesh& mesh : picture.rigid)
            scene.meshes.push_back(surface(mesh, kRigid, false));
        for (const TriMesh& mesh : picture.others)
            scene.meshes.push_back(surface(mesh, kOther, true));
        scene.ground.visible = isOnFloor(picture);
        for (const TriMesh& mesh : picture.cloth)
            scene.meshes.push_back(surface(mesh, colour, true));
    }
    Camera camera;
    camera.eye = toVec3(recipe.eye);
    camera.target = toVec3(recipe.target);
    camera.fov_y_deg = 35.0;
    return renderer.render(scene, camera);
}

}  // namespace

void make_scene_film(const SceneRecipe& recipe, const std::vector<SceneResult>& runs,
                     int pictures_per_second, const std::string& path,
                     const SceneProgress& progress) {
    size_t frames = 0;
    for (const SceneResult& run : runs) frames = std::max(frames, run.pictures.size());
    if (frames == 0) return;
    OsmesaSettings size;
    size.width = kWidth;
    size.height = kHeight;
    OsmesaRenderer renderer(size);
    std::unique_ptr<VideoWriter> video;
    std::vector<Image> kept;
    for (size_t frame = 0; frame < frames; ++frame) {
        std::vector<Image> panels;
        for (size_t k = 0; k < runs.size(); ++k)
            panels.push_back(
                panel(recipe, runs[k], frame, kCloth[k % std::size(kCloth)], renderer));
        const Image image = montage(panels);
        VideoSettings settings;
        settings.fps = pictures_per_second;
        if (!video)
            video = std::make_unique<VideoWriter>(path, image.width(), image.height(), settings);
        video->add(image);
        for (size_t k : {frames / 12, frames / 4, frames - 1})
            if (frame == k) kept.push_back(image);
        if (progress) progress(static_cast<int>(frame) + 1, static_cast<int>(frames));
    }
    video->close();
    MontageSettings column;
    column.columns = 1;
    write_png(std::filesystem::path(path).replace_extension(".png").string(),
              montage(kept, {}, column));
}

}  // namespace cloth
