#include "demos/bullet_scenes/scene_energy.h"

#include "bullet_ext/softBodyGarment.h"
#include "gnn/physics/energy/bending.h"
#include "gnn/physics/energy/strain.h"

namespace cloth {

SceneEnergyMeter::SceneEnergyMeter(const SceneWorld& scene) : m_scene(scene) {
    for (const btSoftBody* body : scene.cloth())
        m_garments.push_back(garmentOfSoftBody(*body, Fabric{}, /*use_body_density=*/false));
}

SceneEnergy SceneEnergyMeter::now() const {
    double kinetic = 0.0, potential = 0.0, mass = 0.0;
    for (size_t k = 0; k < m_garments.size(); ++k) {
        const Garment& garment = m_garments[k];
        const btSoftBody& body = *m_scene.cloth()[k];
        const Points x = nodePositions(body);
        potential += StrainEnergy(garment).value(x) + BendingEnergy(garment).value(x);
        for (int i = 0; i < body.m_nodes.size(); ++i) {
            const double m = garment.masses()[i];
            mass += m;
            potential -= m * toVec3(body.m_worldInfo->m_gravity).dot(x.row(i));
            if (body.m_nodes[i].m_im > 0)
                kinetic += 0.5 * m * toVec3(body.m_nodes[i].m_v).squaredNorm();
        }
    }
    return {kinetic / mass, potential / mass};
}

}  // namespace cloth
