#pragma once

#include <map>
#include <vector>

#include "bullet_ext/partDistance.h"
#include "demos/bullet_scenes/scene_run.h"

namespace cloth {

/// Measures and draws what is in a scene's world.
class SceneProbe {
 public:
    explicit SceneProbe(const SceneWorld& scene) : m_scene(scene) {}

    /// Whether all nodes and rigid bodies have finite positions within 1 km.
    bool finite() const;
    /// Depth (m) of the cloth node that is deepest inside a solid it may touch; 0: none.
    double deepest();
    /// Length over rest length of every link of cloth that is no bending link.
    std::vector<double> stretches() const;
    /// Of all soft bodies; of all rigid bodies (m/s).
    double fastestNode() const;
    double fastestBody() const;
    /// Of cloth and dynamic bodies (kg m/s).
    Vec3 momentum() const;
    std::vector<Points> cloth() const;
    std::vector<Points> others() const;
    ScenePicture picture();

 private:
    struct Solid {
        std::vector<ShapePart> parts;
        std::vector<PartDistance> distances;
    };
    Solid& solidOf(const btCollisionObject& body);

    const SceneWorld& m_scene;
    std::map<const btCollisionObject*, Solid> m_solids;
};

}  // namespace cloth
