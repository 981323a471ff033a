#pragma once

#include <memory>
#include <vector>

#include "render/camera.h"
#include "render/image.h"
#include "render/scene.h"

namespace cloth {

/// Draws a scene into the current OpenGL 3.3 context, with the shaders of the renderer of pictures.
///
///     drawer.load(scene, colours);                       // when the scene has changed
///     drawer.draw(camera, width, height, wireframe);     // in each picture
class Drawer {
 public:
    /// Needs a current context. @throws std::runtime_error if it does not do what is needed
    Drawer();
    ~Drawer();

    /// @param colours  of each mesh: |V| x 3, red, green and blue as shown, 0 to 1; or empty: the
    ///                 mesh's own
    /// @throws ArgumentError naming what cannot be drawn
    void load(const Scene& scene, const std::vector<Points>& colours);

    /// @param wireframe  edges of meshes that have two sides
    void draw(const Camera& camera, int width, int height, bool wireframe);

 private:
    struct Implementation;
    std::unique_ptr<Implementation> m_implementation;
};

/// What the current context has drawn (height x width pixels).
Image drawn_picture(int width, int height);

}  // namespace cloth
