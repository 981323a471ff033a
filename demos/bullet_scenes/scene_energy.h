#pragma once

#include <vector>

#include "data/core/garment.h"
#include "demos/bullet_scenes/worlds/scenes.h"

namespace cloth {

/// Energy of a scene's cloth, per mass: whatever solver moves it, it is taken for our fabric.
struct SceneEnergy {
    double kinetic = 0.0;    ///< (J/kg)
    double potential = 0.0;  ///< stretch, bending and gravity (J/kg)
};

class SceneEnergyMeter {
 public:
    /// Make it before the first step: the shapes are the rest shapes.
    explicit SceneEnergyMeter(const SceneWorld& scene);

    SceneEnergy now() const;

 private:
    const SceneWorld& m_scene;
    std::vector<Garment> m_garments;
};

}  // namespace cloth
