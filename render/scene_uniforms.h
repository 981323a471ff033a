#pragma once

#include "render/camera.h"
#include "render/drawable.h"
#include "render/scene.h"

namespace cloth {

/// Gives shaders (render/shaders.h) what all that a scene draws has in common: the view, the lights
/// and the key light's shadows. OpenGL is reached through `program` alone, as each renderer has
/// loaders of its own.
/// @param program      in use; has set(name, value) for numbers, vectors and matrices
/// @param shadow_size  of the shadow map (texels)
template <typename Program>
void set_scene_uniforms(const Program& program, const Camera& camera, double aspect,
                        const Lights& lights, const ShadowView& shadow, int shadow_size) {
    program.set("view", Eigen::Matrix4f(view_matrix(camera).cast<float>()));
    program.set("projection", Eigen::Matrix4f(projection_matrix(camera, aspect).cast<float>()));
    program.set("world_to_shadow",
                Eigen::Matrix4f(clip_to_texture() * shadow.projection * shadow.view));
    program.set("shadow_texel", shadow.texel);
    program.set("shadow_step", 1.0 / shadow_size);
    program.set("shadow_strength", lights.shadows ? 1.0 : 0.0);
    program.set("eye", camera.eye);
    program.set("key", Vec3(lights.key.normalized()));
    program.set("fill", Vec3(lights.fill.normalized()));
    program.set("key_strength", lights.key_strength);
    program.set("fill_strength", lights.fill_strength);
    program.set("ambient_sky", lights.ambient_sky);
    program.set("ambient_ground", lights.ambient_ground);
}

}  // namespace cloth
