#pragma once

#include <string>
#include <vector>

#include "render/scene.h"

namespace cloth {

/// A mesh as OpenGL draws it: positions (m) and normals interleaved, usable faces only.
struct Drawable {
    std::vector<float> vertices;  ///< 6 per vertex
    std::vector<unsigned> indices;
};

/// @param name  for messages, such as "Scene::meshes[0]"
/// @throws ArgumentError if a face names a vertex that does not exist, or a value is out of range
Drawable drawable_of(const std::string& name, const SceneMesh& mesh);
/// The floor, as far as it is seen.
Drawable ground_quad(const Ground& ground);

/// The key light's view of the scene.
struct ShadowView {
    Eigen::Matrix4f view = Eigen::Matrix4f::Identity();
    Eigen::Matrix4f projection = Eigen::Matrix4f::Identity();
    double texel = 0.0;  ///< (m)
};

/// An orthographic box around all that throws a shadow, seen along the key light.
/// @param size  of the map (texels)
ShadowView shadow_view(const std::vector<Drawable>& drawables, const Vec3& key, int size);

/// Clip coordinates (-1 to 1) to texture coordinates (0 to 1).
Eigen::Matrix4f clip_to_texture();

/// What is shown to the light that shaders calculate with: the inverse of their shown().
Eigen::Vector3f linear(Rgb colour);

/// @throws ArgumentError naming the value that is out of range
void check_ground_and_lights(const Scene& scene);

}  // namespace cloth
