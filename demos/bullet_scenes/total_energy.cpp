#include "demos/bullet_scenes/total_energy.h"

#include <algorithm>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "bullet_ext/softBodyGarment.h"
#include "gnn/physics/energy/bending.h"
#include "gnn/physics/energy/strain.h"

namespace cloth {

namespace {

double massOf(const btSoftBody::Node& node) {
    return node.m_im > 0 ? 1.0 / static_cast<double>(node.m_im) : 0.0;
}

void addNode(const btSoftBody& body, int i, double mass, TotalEnergy& energy) {
    const btSoftBody::Node& node = body.m_nodes[i];
    energy.kinetic += 0.5 * mass * toVec3(node.m_v).squaredNorm();
    energy.gravity -= mass * toVec3(body.m_worldInfo->m_gravity).dot(toVec3(node.m_x));
}

void addRigid(const btRigidBody& body, TotalEnergy& energy) {
    if (!(body.getInvMass() > 0)) return;
    const double mass = 1.0 / static_cast<double>(body.getInvMass());
    const Vec3 spin = toMatrix(body.getWorldTransform().getBasis()).transpose() *
                      toVec3(body.getAngularVelocity());
    const Vec3 inverse_inertia = toVec3(body.getInvInertiaDiagLocal());
    energy.kinetic += 0.5 * mass * toVec3(body.getLinearVelocity()).squaredNorm();
    for (int k = 0; k < 3; ++k)
        if (inverse_inertia[k] > 0.0)
            energy.kinetic += 0.5 * spin[k] * spin[k] / inverse_inertia[k];
    energy.gravity -=
        mass * toVec3(body.getGravity()).dot(toVec3(body.getWorldTransform().getOrigin()));
}

double longestSide(const btSoftBody& body) {
    const Points x = nodePositions(body);
    return (x.colwise().maxCoeff() - x.colwise().minCoeff()).maxCoeff();
}

}  // namespace

/// Energies of one garment, made once.
class TotalEnergyMeter::Elastic {
 public:
    explicit Elastic(const Garment& garment)
        : m_garment(&garment), m_strain(garment), m_bending(garment) {}

    bool isOf(const Garment& garment) const { return m_garment == &garment; }
    double at(const Points& x) const { return m_strain.value(x) + m_bending.value(x); }

 private:
    const Garment* m_garment;
    StrainEnergy m_strain;
    BendingEnergy m_bending;
};

TotalEnergyMeter::~TotalEnergyMeter() = default;

TotalEnergyMeter::TotalEnergyMeter(const SceneWorld& scene, const btGnnSoftBodySolver* solver)
    : m_scene(scene), m_solver(solver) {
    double weight = 0.0, side = 0.0;
    for (const auto& body : scene.rigid())
        if (body->getInvMass() > 0)
            weight += toVec3(body->getGravity()).norm() / static_cast<double>(body->getInvMass());
    for (const auto* bodies : {&scene.cloth(), &scene.others()})
        for (const btSoftBody* body : *bodies) {
            const double gravity = toVec3(body->m_worldInfo->m_gravity).norm();
            for (int i = 0; i < body->m_nodes.size(); ++i)
                weight += gravity * massOf(body->m_nodes[i]);
            side = std::max(side, longestSide(*body));
        }
    m_scale = weight * side + now().kinetic;
}

void TotalEnergyMeter::addCloth(const btSoftBody& body, TotalEnergy& energy) {
    const Garment* garment = m_solver ? m_solver->garmentOf(&body) : nullptr;
    const double ratio = garment ? massRatio(body, *garment) : 0.0;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const double mass = massOf(body.m_nodes[i]);
        addNode(body, i, garment && mass > 0.0 ? ratio * garment->masses()[i] : mass, energy);
    }
    if (!garment) return;
    auto& elastic = m_elastic[&body];
    if (!elastic || !elastic->isOf(*garment)) elastic = std::make_unique<Elastic>(*garment);
    energy.elastic += ratio * elastic->at(nodePositions(body));
}

TotalEnergy TotalEnergyMeter::now() {
    TotalEnergy energy;
    for (const auto& body : m_scene.rigid()) addRigid(*body, energy);
    for (const btSoftBody* body : m_scene.cloth()) addCloth(*body, energy);
    for (const btSoftBody* body : m_scene.others())
        for (int i = 0; i < body->m_nodes.size(); ++i)
            addNode(*body, i, massOf(body->m_nodes[i]), energy);
    return energy;
}

}  // namespace cloth
