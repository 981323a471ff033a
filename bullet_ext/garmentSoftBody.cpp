#include "bullet_ext/garmentSoftBody.h"

#include <BulletSoftBody/btSoftBody.h>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

void configure(btSoftBody& body, const SoftBodySettings& settings) {
    body.m_cfg.piterations = settings.iterations;
    body.m_cfg.kDF = static_cast<btScalar>(settings.friction);
    body.m_cfg.kCHR = body.m_cfg.kKHR = static_cast<btScalar>(settings.contact_hardness);
    body.m_cfg.kDP = 0;
    body.getCollisionShape()->setMargin(static_cast<btScalar>(settings.margin));
}

void appendLinks(btSoftBody& body, const Garment& garment, const SoftBodySettings& settings) {
    btSoftBody::Material* edges = body.m_materials[0];
    edges->m_kLST = static_cast<btScalar>(settings.stiffness);
    for (const auto& [a, b] : garment.edges()) body.appendLink(a, b, edges);
    if (!(settings.bending > 0.0)) return;
    btSoftBody::Material* bending = body.appendMaterial();
    bending->m_kLST = static_cast<btScalar>(settings.bending);
    bending->m_flags = 0;
    for (const Hinge& hinge : garment.hinges()) {
        body.appendLink(hinge[2], hinge[3], bending);
        body.m_links[body.m_links.size() - 1].m_bbending = -1;  // a signed bit: true
    }
}

}  // namespace

void checkSoftBodySettings(const SoftBodySettings& settings) {
    check_range("SoftBodySettings.iterations", settings.iterations, 1, 1000);
    check_range("SoftBodySettings.margin", settings.margin, 1e-4, 0.25);
    check_range("SoftBodySettings.stiffness", settings.stiffness, 0.0, 1.0);
    check_range("SoftBodySettings.bending", settings.bending, 0.0, 1.0);
    check_range("SoftBodySettings.friction", settings.friction, 0.0, 1.0);
    check_range("SoftBodySettings.contact_hardness", settings.contact_hardness, 0.0, 1.0);
}

btSoftBody* createGarmentSoftBody(btSoftBodyWorldInfo& info, const Garment& garment,
                                  const ClothState& state, const SoftBodySettings& settings) {
    checkSoftBodySettings(settings);
    if (state.x.rows() != garment.vertex_count() || state.v.rows() != garment.vertex_count())
        throw ArgumentError("state of garment " + garment.name(),
                            "has another number of vertices than the garment",
                            "start from ClothState::at_rest()");
    const int count = static_cast<int>(garment.vertex_count());
    std::vector<btVector3> x;
    std::vector<btScalar> masses;
    for (int i = 0; i < count; ++i) {
        x.push_back(toBullet(Vec3(garment.rest().vertices.row(i))));
        const bool pinned = garment.is_pinned()[static_cast<size_t>(i)];
        masses.push_back(pinned ? 0 : static_cast<btScalar>(garment.masses()[i]));
    }
    auto* body = new btSoftBody(&info, count, x.data(), masses.data());
    configure(*body, settings);
    appendLinks(*body, garment, settings);
    for (Eigen::Index f = 0; f < garment.face_count(); ++f) {
        const auto face = garment.rest().faces.row(f);
        body->appendFace(face[0], face[1], face[2]);
    }
    // Otherwise Bullet would take the lengths of the first step, not these, for rest lengths.
    body->updateConstants();
    body->m_bUpdateRtCst = false;
    loadState(state, *body);
    return body;
}

btSoftBody* createGarmentSoftBody(btSoftBodyWorldInfo& info, const Garment& garment,
                                  const SoftBodySettings& settings) {
    return createGarmentSoftBody(info, garment, ClothState::at_rest(garment), settings);
}

void loadState(const ClothState& state, btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body.m_nodes[i];
        node.m_x = node.m_q = toBullet(Vec3(state.x.row(i)));
        node.m_v = node.m_vn = toBullet(Vec3(state.v.row(i)));
        node.m_f.setZero();
    }
    body.m_rcontacts.clear();
    body.m_scontacts.clear();
    body.updateNormals();
    body.updateNodeTree(/*use_velocity=*/false, /*margin=*/true);
    body.updateFaceTree(/*use_velocity=*/false, /*margin=*/true);
    body.updateBounds();
}

void storeState(const btSoftBody& body, ClothState& state) {
    state.x.resize(body.m_nodes.size(), 3);
    state.v.resize(body.m_nodes.size(), 3);
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        state.x.row(i) = toVec3(body.m_nodes[i].m_x);
        state.v.row(i) = toVec3(body.m_nodes[i].m_v);
    }
}

}  // namespace cloth
