#include "demos/bake/bake_scene.h"

#include "demos/compare/body_scene.h"

namespace cloth {

BakeScene make_bake_scene(const BakeOptions& options) {
    if (!options.character.character.empty()) {
        const auto scene = std::make_shared<const CharacterScene>(options.character);
        return {scene, scene->rest_skin(), [scene](double time) { return scene->skin(time); }};
    }
    BodySceneSettings settings;
    settings.garment = options.garment;
    settings.fabric = options.fabric;
    settings.motion = options.motion;
    settings.rate = options.rate;
    settings.frames = options.frames == 0 ? 0 : options.frames - 1;
    settings.limbs = true;
    const auto scene = std::make_shared<const BodyScene>(settings);
    return {scene, scene->body().body().rest_mesh(),
            [scene](double time) { return scene->skin(time); }};
}

}  // namespace cloth
