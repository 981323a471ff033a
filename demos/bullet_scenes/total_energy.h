#pragma once

#include <map>
#include <memory>

#include "demos/bullet_scenes/worlds/scenes.h"

class btGnnSoftBodySolver;

namespace cloth {

/// Energy of everything in a scene that moves (J).
struct TotalEnergy {
    double kinetic = 0.0;  ///< of rigid bodies, cloth and other soft bodies
    double gravity = 0.0;
    double elastic = 0.0;  ///< stretch and bending of the cloth that our solver steps: the links of
                           ///< Bullet's solver store no energy that could be told

    double sum() const { return kinetic + gravity + elastic; }
};

/// Masses are those of Bullet's nodes; cloth of our solver has them spread by area, and energies of
/// its own fabric in proportion, as its reactions on bodies have.
class TotalEnergyMeter {
 public:
    /// @param solver  the scene's; null is Bullet's own
    TotalEnergyMeter(const SceneWorld& scene, const btGnnSoftBodySolver* solver);
    ~TotalEnergyMeter();

    TotalEnergy now();

    /// What energies of the scene are compared with (J): the weight of all that moves times the
    /// longest side of its largest soft body, and the kinetic energy that it starts with.
    double scale() const { return m_scale; }

 private:
    class Elastic;
    void addCloth(const btSoftBody& body, TotalEnergy& energy);

    const SceneWorld& m_scene;
    const btGnnSoftBodySolver* m_solver;
    std::map<const btSoftBody*, std::unique_ptr<Elastic>> m_elastic;
    double m_scale = 0.0;
};

}  // namespace cloth
