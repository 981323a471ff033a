#pragma once

#include <string>

#include "render/camera.h"
#include "render/image.h"
#include "render/scene.h"

namespace cloth {

/// Draws scenes. Equal scenes and cameras give equal pictures.
class Renderer {
 public:
    virtual ~Renderer() = default;

    virtual std::string name() const = 0;

    /// @throws ArgumentError naming the mesh, camera or label that cannot be drawn
    virtual Image render(const Scene& scene, const Camera& camera) = 0;
};

}  // namespace cloth
