#include "scene_world.h"

#include <algorithm>

SceneWorld::SceneWorld(btSoftBodySolver* solver)
    : m_dispatcher(&m_config),
      m_world(&m_dispatcher, &m_broadphase, &m_rigidSolver, &m_config, solver) {
    m_world.setGravity({0, -9.81f, 0});
    info().m_gravity = {0, -9.81f, 0};  // soft bodies have their own, and -10 until it is set
    info().m_dispatcher = &m_dispatcher;
    info().m_broadphase = &m_broadphase;
    info().m_sparsesdf.Initialize();
    // Bullet's own cloth passes through small bodies with the cells of 0.25 m it starts with.
    info().m_sparsesdf.setDefaultVoxelsz(0.05f);
    info().m_sparsesdf.Reset();
}

SceneWorld::~SceneWorld() {
    for (auto& body : m_soft) m_world.removeSoftBody(body.get());
    for (auto& body : m_rigid) m_world.removeRigidBody(body.get());
    for (auto& object : m_objects) m_world.removeCollisionObject(object.get());
}

void SceneWorld::setUpLikeBulletsDemos() {
    m_world.setGravity({0, -10, 0});
    info().m_gravity = {0, -10, 0};
    info().m_sparsesdf.setDefaultVoxelsz(0.25f);
    info().m_sparsesdf.Reset();
}

void SceneWorld::step(btScalar h) {
    m_time += h;
    if (drive) drive(static_cast<btScalar>(m_time));
    m_world.stepSimulation(h, 0);
    info().m_sparsesdf.GarbageCollect();
}

btRigidBody* SceneWorld::addRigid(btCollisionShape* shape, const btVector3& position, btScalar mass,
                                  bool kinematic) {
    keepShape(shape);
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    auto body = std::make_unique<btRigidBody>(mass, nullptr, shape, inertia);
    body->setWorldTransform(btTransform(btQuaternion::getIdentity(), position));
    body->setInterpolationWorldTransform(body->getWorldTransform());
    if (kinematic) {
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
        body->setActivationState(DISABLE_DEACTIVATION);
    }
    m_world.addRigidBody(body.get());
    m_rigid.push_back(std::move(body));
    return m_rigid.back().get();
}

btCollisionObject* SceneWorld::addObject(btCollisionShape* shape, const btVector3& position) {
    auto object = std::make_unique<btCollisionObject>();
    object->setCollisionShape(keepShape(shape));
    object->setWorldTransform(btTransform(btQuaternion::getIdentity(), position));
    object->setInterpolationWorldTransform(object->getWorldTransform());
    m_world.addCollisionObject(object.get());
    m_objects.push_back(std::move(object));
    return m_objects.back().get();
}

btCollisionShape* SceneWorld::keepShape(btCollisionShape* shape) {
    const auto same = [&](const auto& kept) { return kept.get() == shape; };
    if (std::none_of(m_shapes.begin(), m_shapes.end(), same)) m_shapes.emplace_back(shape);
    return shape;
}

std::vector<const btCollisionObject*> SceneWorld::solids() const {
    std::vector<const btCollisionObject*> all;
    for (const auto& body : m_rigid) all.push_back(body.get());
    for (const auto& object : m_objects) all.push_back(object.get());
    return all;
}

btSoftBody* SceneWorld::addSoft(btSoftBody* body) {
    m_soft.emplace_back(body);
    m_others.push_back(body);
    m_world.addSoftBody(body);
    return body;
}

btSoftBody* SceneWorld::addClothAsItIs(btSoftBody* cloth) {
    addSoft(cloth);
    m_others.pop_back();
    m_cloth.push_back(cloth);
    return cloth;
}

btSoftBody* SceneWorld::addCloth(btSoftBody* cloth, btScalar mass) {
    addClothAsItIs(cloth);
    cloth->setTotalMass(mass);
    cloth->getCollisionShape()->setMargin(0.01f);
    cloth->m_cfg.piterations = 10;
    cloth->m_cfg.kDP = 0.01f;
    cloth->m_cfg.kDF = 0.5f;
    cloth->m_cfg.kCHR = cloth->m_cfg.kKHR = 1;
    return cloth;
}

btSoftBody* SceneWorld::addSheet(const btVector3& centre, btScalar side, int n, int corners) {
    const btScalar r = side / 2;
    btSoftBody* sheet = btSoftBodyHelpers::CreatePatch(
        info(), centre + btVector3(-r, 0, -r), centre + btVector3(r, 0, -r),
        centre + btVector3(-r, 0, r), centre + btVector3(r, 0, r), n, n, corners, true);
    const btScalar density = 0.2f;  // kg/m^2
    return addCloth(sheet, density * side * side);
}

btTriangleMesh* SceneWorld::newTriangles() {
    m_triangles.push_back(std::make_unique<btTriangleMesh>());
    return m_triangles.back().get();
}

void SceneWorld::closeSystem() {
    m_world.setGravity({0, 0, 0});
    info().m_gravity.setZero();
    for (auto& object : m_objects) m_world.removeCollisionObject(object.get());
    m_objects.clear();
    for (auto& body : m_rigid) {
        body->setGravity({0, 0, 0});
        if (body->isStaticOrKinematicObject()) m_world.removeRigidBody(body.get());
    }
    for (size_t i = m_rigid.size(); i-- > 0;)
        if (m_rigid[i]->isStaticOrKinematicObject())
            m_rigid.erase(m_rigid.begin() + static_cast<std::ptrdiff_t>(i));
    for (btSoftBody* body : m_cloth) {
        body->m_cfg.kDP = 0;
        const btScalar mass = body->getTotalMass();
        for (int i = 0; i < body->m_nodes.size(); ++i) body->setMass(i, 1);
        body->setTotalMass(mass, /*fromfaces=*/true);  // as the mass of cloth is: by area
    }
}
