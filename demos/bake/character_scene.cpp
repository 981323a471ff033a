#include "demos/bake/character_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "data/body/garment_fit.h"
#include "data/core/check_range.h"
#include "data/files/garment_assets.h"
#include "demos/compare/body_scene.h"
#include "demos/dressing_checks.h"

namespace cloth {
namespace {

std::shared_ptr<const WeldedCharacter> character_of(const CharacterSceneSettings& settings) {
    auto skin =
        std::make_shared<const WeldedCharacter>(settings.character, settings.skin, settings.weld);
    check_height(settings.character, *skin);
    return skin;
}

/// At rest and as it is worn on the bind pose, which a waistband makes two shapes.
struct WornGarment {
    TriMesh rest;
    Points worn;
};

WornGarment mesh_of(const CharacterSceneSettings& settings) {
    check_range("--garment-scale", settings.garment_scale, 1e-6, 1e6);
    const ClothState start = load_garment_start(settings.garment);
    TriMesh mesh = load_garment_mesh(settings.garment);
    mesh.vertices *= settings.garment_scale;
    WeldedMesh welded = weld_mesh(mesh, settings.weld);
    return {std::move(welded.mesh), settings.garment_scale * start.x(welded.kept, Eigen::all)};
}

Garment garment_of(const CharacterSceneSettings& settings) {
    TriMesh mesh = mesh_of(settings).rest;
    const std::vector<int> pins = vertices_between(mesh.vertices, settings.pin);
    return Garment("garment", std::move(mesh), fabric_named(settings.fabric), pins);
}

}  // namespace

CharacterScene::CharacterScene(const CharacterSceneSettings& settings)
    : CharacterScene(settings, character_of(settings)) {
}

CharacterScene::CharacterScene(const CharacterSceneSettings& settings,
                               std::shared_ptr<const WeldedCharacter> skin)
    : ComparisonScene(garment_of(settings), settings.rate),
      m_skin(std::move(skin)),
      m_start(ClothState::at_rest(garment())),
      m_lead_in_frames(static_cast<int>(std::lround(settings.settle * settings.rate))) {
    check_range("--clearance", settings.clearance, 1e-3, 0.05);
    check_range("--settle", settings.settle, 0.0, 60.0);
    distance_to_skin(garment(), *m_skin);
    GarmentFitSettings fit;
    fit.clearance = settings.clearance;
    m_start.x = fit_garment({mesh_of(settings).worn, garment().rest().faces}, rest_skin(),
                            m_skin->vertices(0.0), fit);
    m_band = std::make_unique<const SkinBinding>(TriMesh{m_skin->vertices(0.0), *m_skin->faces()},
                                                 m_start.x(garment().pins(), Eigen::all));
    const int available = m_skin->frame_count(frame_time()) - 1;
    if (available < 1)
        throw ArgumentError(settings.character, "its animation is shorter than one frame",
                            "give a file with an animation, or its name with --motion");
    set_length(settings.steps == 0 ? available : std::min(settings.steps, available), 0);
}

Points CharacterScene::skin(double time) const {
    return m_skin->vertices(std::max(0.0, time));
}

Boundary CharacterScene::boundary(double t0, double t1) const {
    Boundary boundary;
    boundary.obstacles.push_back(m_skin->obstacle(std::max(0.0, t0), std::max(0.0, t1)));
    boundary.pin_targets = m_band->positions(boundary.obstacles[0].x1);
    return boundary;
}

}  // namespace cloth
