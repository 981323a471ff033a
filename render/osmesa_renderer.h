#pragma once

#include <memory>

#include "render/renderer.h"

namespace cloth {

struct OsmesaSettings {
    int width = 640;            ///< of the picture (pixels), 16 to 4096
    int height = 720;           ///< (pixels), 16 to 4096
    int shadow_size = 1024;     ///< side of the shadow map (texels), 64 to 4096: small is blurred
    bool anti_aliasing = true;  ///< draw at twice the size and average: 4 samples per pixel
};

/// Renderer without a screen, window system or graphics card: Mesa's software rasteriser.
///
///     OsmesaRenderer renderer(OsmesaSettings{});
///     write_png("shirt.png", renderer.render(scene, camera));
///
/// One renderer serves one thread at a time.
class OsmesaRenderer : public Renderer {
 public:
    /// @throws ArgumentError for sizes out of range
    /// @throws LoadError if OSMesa or the font of the labels is missing or does not work
    explicit OsmesaRenderer(const OsmesaSettings& settings);
    ~OsmesaRenderer() override;

    std::string name() const override { return "OSMesa"; }
    Image render(const Scene& scene, const Camera& camera) override;

 private:
    class Implementation;
    std::unique_ptr<Implementation> m_implementation;
};

}  // namespace cloth
