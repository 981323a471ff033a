#include "demos/bake/bake_scene.h"

#include "demos/compare/body_scene.h"

namespace cloth {

BakeScene make_bake_scene(const SceneOptions& options) {
    if (!options.character.character.empty()) {
        const auto scene = std::make_shared<const CharacterScene>(options.character);
        return {scene, scene->rest_skin(), [scene](double time) { return scene->skin(time); },
                scene->parts(), scene->notes()};
    }
    BodySceneSettings settings;
    settings.garment = options.garment;
    settings.fabric = options.fabric;
    settings.body = options.shape;
    settings.motion = options.motion;
    settings.rate = options.rate;
    settings.frames = options.frames == 0 ? 0 : options.frames - 1;
    settings.limbs = true;
    const auto scene = std::make_shared<const BodyScene>(settings);
    BakeScene made{scene,
                   scene->body().body().rest_mesh(),
                   [scene](double time) { return scene->skin(time); },
                   {},
                   {}};
    for (int part = 0; part < scene->outfit().part_count(); ++part)
        made.parts.push_back(scene->outfit().faces_of_part(part));
    return made;
}

}  // namespace cloth
