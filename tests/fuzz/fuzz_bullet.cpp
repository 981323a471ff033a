#include "tests/fuzz/fuzz_bullet.h"

#include <algorithm>
#include <limits>

#include "data/core/errors.h"
#include "tests/fuzz/fuzz_meshes.h"

namespace cloth::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

float scalar(Random& random, double low, double high) {
    return static_cast<float>(random.uniform(low, high));
}

btVector3 vector(Random& random, double most) {
    const float x = scalar(random, -most, most), y = scalar(random, -most, most);
    return {x, y, scalar(random, -most, most)};
}

/// Mostly about `usual`; now and then zero, tiny, huge or no number.
float number(Random& random, double usual) {
    if (random.chance(0.8)) return scalar(random, -usual, usual);
    return random.one_of<float>({0, 1e-30f, 1e6f, -1e6f, 1e20f, 1e38f, nan, infinity});
}

btVector3 numbers(Random& random, double usual) {
    const float x = number(random, usual), y = number(random, usual);
    return {x, y, number(random, usual)};
}

btTransform random_transform(Random& random, double reach) {
    btQuaternion turn(scalar(random, -1, 1), scalar(random, -1, 1), scalar(random, -1, 1), 0.5f);
    return btTransform(turn.normalized(), vector(random, reach));
}

int any_node(const btSoftBody& body, Random& random) {
    return static_cast<int>(random.below(static_cast<size_t>(body.m_nodes.size())));
}

void append_triangle(btSoftBody& body, Random& random) {
    const int a = any_node(body, random), b = any_node(body, random), c = any_node(body, random);
    body.appendLink(a, b, nullptr, /*bcheckexist=*/true);
    body.appendFace(a, b, c);
}

btSoftBody* soft_patch(btSoftBodyWorldInfo& info, Random& random) {
    return test::patch(info, vector(random, 0.5), random.between(2, 7), random.between(0, 15));
}

btSoftBody* soft_mesh(btSoftBodyWorldInfo& info, Random& random) {
    TriMesh mesh = random_mesh(random);
    const auto out_of_range = [&](int v) { return v < 0 || v >= mesh.vertices.rows(); };
    std::vector<int> indices;  // Bullet reads them unchecked
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        if (!out_of_range(mesh.faces(f, 0)) && !out_of_range(mesh.faces(f, 1)) &&
            !out_of_range(mesh.faces(f, 2)))
            for (int c = 0; c < 3; ++c) indices.push_back(mesh.faces(f, c));
    if (indices.empty()) return soft_patch(info, random);
    std::vector<btScalar> vertices;
    for (Eigen::Index v = 0; v <= *std::max_element(indices.begin(), indices.end()); ++v)
        for (int c = 0; c < 3; ++c) vertices.push_back(static_cast<float>(mesh.vertices(v, c)));
    return btSoftBodyHelpers::CreateFromTriMesh(info, vertices.data(), indices.data(),
                                                static_cast<int>(indices.size() / 3), false);
}

btSoftBody* soft_by_hand(btSoftBodyWorldInfo& info, Random& random) {
    auto* body = new btSoftBody(&info);
    body->appendMaterial();
    for (int i = random.between(1, 12); i > 0; --i)
        body->appendNode(random.chance(0.97) ? vector(random, 0.4) : numbers(random, 0.4),
                         random.one_of<float>({1, 1, 1, 0.1f, 0, 1e30f}));
    for (int f = random.between(0, 12); f > 0; --f) append_triangle(*body, random);
    return body;
}

void spoil(btSoftBody& body, Random& random) {
    btSoftBody::Node& node = body.m_nodes[any_node(body, random)];
    switch (random.between(0, 5)) {
        case 0:
            body.appendNode(vector(random, 0.5), 1);
            break;
        case 1:
            append_triangle(body, random);
            break;
        case 2:
            node.m_x = body.m_nodes[any_node(body, random)].m_x;
            break;
        case 3:
            node.m_x = numbers(random, 1);
            break;
        case 4:
            node.m_im = random.one_of<float>({0, -1, nan, infinity, 1e30f, 1e-30f});
            break;
        default:
            body.setTotalMass(random.one_of<float>({0, 1, 1e-20f, 1e20f}), random.chance(0.5));
            break;
    }
}

btCollisionShape* triangle_shape(Random& random) {
    // Kept for good: shapes do not own their triangles.
    static std::vector<std::unique_ptr<btTriangleMesh>> all;
    all.push_back(std::make_unique<btTriangleMesh>());
    for (int f = random.between(1, 8); f > 0; --f) {
        const btVector3 a = vector(random, 0.4);
        all.back()->addTriangle(a, random.chance(0.1) ? a : vector(random, 0.4),
                                vector(random, 0.4));
    }
    return new btBvhTriangleMeshShape(all.back().get(), true);
}

btCollisionShape* hull_shape(Random& random) {
    auto* hull = new btConvexHullShape;
    const float thickness = random.one_of<float>({1, 1, 0.01f, 0});
    for (int i = random.between(1, 20); i > 0; --i)
        hull->addPoint(vector(random, 0.3) * btVector3(1, thickness, 1));
    return hull;
}

}  // namespace

btSoftBody* random_soft_body(btSoftBodyWorldInfo& info, Random& random) {
    const int kind = random.between(0, 3);
    btSoftBody* body = kind < 2    ? soft_patch(info, random)
                       : kind == 2 ? soft_mesh(info, random)
                                   : soft_by_hand(info, random);
    for (int defects = random.one_of<int>({0, 0, 0, 1, 2}); defects > 0; --defects)
        spoil(*body, random);
    return body;
}

btCollisionShape* random_shape(Random& random) {
    const auto size = [&] {
        return random.chance(0.9) ? scalar(random, 0.02, 0.4)
                                  : random.one_of<float>({0, 1e-9f, 1e5f});
    };
    const float a = size(), b = size(), c = size();
    switch (random.between(0, 8)) {
        case 0:
            return new btSphereShape(a);
        case 1:
            return new btBoxShape({a, b, c});
        case 2:
            return new btCapsuleShape(a, b);
        case 3:
            return new btCylinderShape({a, b, a});
        case 4:
            return new btConeShape(a, b);
        case 5:
            return new btStaticPlaneShape({0, 1, 0}, -0.5f);
        case 6:
            return hull_shape(random);
        case 7:
            return triangle_shape(random);
        default:
            return new btEmptyShape;
    }
}

void WorldMeddler::add_soft_body() {
    btSoftBody* body = random_soft_body(m_world.info(), m_random);
    if (m_random.chance(0.5)) body->m_cfg.kDP = scalar(m_random, 0, 0.1);
    m_soft.push_back(m_world.add(body));
}

void WorldMeddler::remove_soft_body() {
    if (m_soft.empty()) return;
    const size_t k = m_random.below(m_soft.size());
    m_world.remove(m_soft[k]);
    m_soft.erase(m_soft.begin() + static_cast<std::ptrdiff_t>(k));
}

void WorldMeddler::add_rigid_body() {
    btCollisionShape* shape = random_shape(m_random);
    const bool may_move = !shape->isConcave() && shape->getShapeType() != EMPTY_SHAPE_PROXYTYPE;
    const float mass =
        may_move && m_random.chance(0.4) ? static_cast<float>(m_random.magnitude(1e-3, 1e3)) : 0.0f;
    const bool kinematic = mass == 0 && m_random.chance(0.3);
    m_rigid.push_back(m_world.add(shape, vector(m_random, 0.7), kinematic, mass));
    m_rigid.back()->setFriction(scalar(m_random, 0, 1.5));
}

void WorldMeddler::remove_rigid_body() {
    if (m_rigid.empty()) return;
    const size_t k = m_random.below(m_rigid.size());
    for (btSoftBody* body : m_soft)  // the user's duty in Bullet, too
        for (int a = body->m_anchors.size() - 1; a >= 0; --a)
            if (body->m_anchors[a].m_body == m_rigid[k]) {
                body->m_anchors.swap(a, body->m_anchors.size() - 1);
                body->m_anchors.pop_back();
            }
    m_solver.removeAnimatedObstacle(m_rigid[k]);
    m_world.remove(m_rigid[k]);
    m_rigid.erase(m_rigid.begin() + static_cast<std::ptrdiff_t>(k));
}

void WorldMeddler::change_nodes(btSoftBody& body) {
    const int i = any_node(body, m_random);
    btSoftBody::Node& node = body.m_nodes[i];
    switch (m_random.between(0, 4)) {
        case 0:
            body.setMass(i, m_random.one_of<float>({0, 0, 1, 0.01f, 1e20f}));
            break;
        case 1:
            node.m_x += numbers(m_random, 0.1);
            break;
        case 2:
            node.m_v = numbers(m_random, 5);
            break;
        case 3:
            node.m_f = numbers(m_random, 10);
            break;
        default:
            if (m_random.chance(0.3)) spoil(body, m_random);
            break;
    }
}

void WorldMeddler::move_body(btSoftBody& body) {
    switch (m_random.between(0, 4)) {
        case 0:
            body.translate(m_random.chance(0.8) ? vector(m_random, 1) : numbers(m_random, 1e3));
            break;
        case 1:
            body.rotate(random_transform(m_random, 0).getRotation());
            break;
        case 2:
            body.transform(random_transform(m_random, 1));
            break;
        case 3: {
            const float s = m_random.one_of<float>({0.5f, 1.5f, 3, 1e-6f, 0, -1, 1e4f, nan});
            body.scale({s, s, m_random.chance(0.5) ? s : 1});
            break;
        }
        default:
            body.setRestLengthScale(m_random.one_of<float>({0.5f, 1.3f, 0, -1, 1e6f, nan}));
            break;
    }
}

void WorldMeddler::push(btSoftBody& body) {
    switch (m_random.between(0, 4)) {
        case 0:
            body.setVelocity(numbers(m_random, 5));
            break;
        case 1:
            body.addVelocity(numbers(m_random, 5));
            break;
        case 2:
            body.addForce(numbers(m_random, 10));
            break;
        case 3:
            body.addForce(numbers(m_random, 10), any_node(body, m_random));
            break;
        default:
            body.setWindVelocity(numbers(m_random, 10));
            body.m_cfg.aeromodel = static_cast<btSoftBody::eAeroModel::_>(m_random.between(0, 6));
            body.m_cfg.kDG = number(m_random, 0.1);
            body.m_cfg.kLF = number(m_random, 0.1);
            break;
    }
}

void WorldMeddler::change_settings(btSoftBody& body) {
    btSoftBody::Config& cfg = body.m_cfg;
    switch (m_random.between(0, 6)) {
        case 0:
            cfg.kDP = number(m_random, 1);
            break;
        case 1:
            cfg.kDF = number(m_random, 1);
            break;
        case 2:
            cfg.timescale =
                m_random.one_of<float>({1, 1, 0.3f, 2, 0, -1, 1e-20f, 1e6f, nan, infinity});
            break;
        case 3:
            cfg.kAHR = number(m_random, 1);
            break;
        case 4:
            cfg.piterations = m_random.one_of<int>({0, 1, 4, -3, 1000});
            break;
        case 5:
            cfg.kPR = m_random.one_of<float>({0, 0, 1});
            break;
        default:
            body.getCollisionShape()->setMargin(m_random.one_of<float>({0, 0.01f, 1, -1}));
            break;
    }
}

void WorldMeddler::change_topology(btSoftBody& body) {
    if (m_random.chance(0.5)) return append_triangle(body, m_random);
    if (m_random.chance(0.5)) {
        body.appendNode(vector(m_random, 0.5), 1);
    } else if (body.m_faces.size() > 1) {
        body.m_faces.pop_back();
    }
}

void WorldMeddler::anchor(btSoftBody& body) {
    if (m_rigid.empty()) return;
    if (body.m_anchors.size() > 0 && m_random.chance(0.3)) return body.m_anchors.pop_back();
    btRigidBody* to = m_random.one_of(m_rigid);
    const float influence = m_random.one_of<float>({1, 1, 0.5f, 0.01f, 0, -1, 7, nan});
    body.appendAnchor(any_node(body, m_random), to, m_random.chance(0.5), influence);
}

void WorldMeddler::put_to_sleep_or_wake(btSoftBody& body) {
    if (m_random.chance(0.4)) return body.activate(true);
    body.forceActivationState(m_random.one_of<int>({ACTIVE_TAG, ISLAND_SLEEPING, WANTS_DEACTIVATION,
                                                    DISABLE_DEACTIVATION, DISABLE_SIMULATION}));
}

/// Errors are thrown here, and name the body.
void WorldMeddler::ask_the_solver(btSoftBody& body) {
    try {
        const int question = m_random.between(0, 3);
        if (question == 0) m_solver.detach(&body);
        if (question == 1) m_solver.attach(&body, random_fabric(m_random));
        if (question >= 2) m_solver.attach(&body);
    } catch (const ArgumentError&) {
    }
}

void WorldMeddler::set_goals(btSoftBody& body) {
    const double strange = m_random.one_of<double>({0, 0.1, 1e-9, 1e9, 1e300, nan, -1});
    const int nodes = body.m_nodes.size() + (m_random.chance(0.1) ? 1 : 0);
    try {
        if (m_random.chance(0.3)) {
            GoalLimits limits;
            for (VectorX* array : {&limits.max_distance, &limits.backstop, &limits.drive_stiffness,
                                   &limits.drive_damping})
                if (m_random.chance(0.5)) array->setConstant(nodes, strange);
            return m_solver.setGoalLimits(&body, limits);
        }
        if (m_random.chance(0.2))
            return m_solver.teleport(
                &body, random_transform(m_random, 0.7),
                m_random.chance(0.5) ? btGnnTeleport::keep : btGnnTeleport::reset);
        Points x(nodes, 3);
        for (Eigen::Index k = 0; k < x.size(); ++k) x.data()[k] = m_random.uniform(-1.0, 1.0);
        SkinGoals goals = SkinGoals::at(x, x);
        if (m_random.chance(0.3)) goals.x1.array() += strange;
        if (m_random.chance(0.3)) goals.normal1 = {};
        m_solver.setGoals(&body, goals, m_random.one_of<double>({0, 1.0 / 60.0, 1e-300, 1e9}));
    } catch (const ArgumentError&) {
    }
}

void WorldMeddler::animate(btRigidBody& body) {
    TriMesh mesh = random_mesh(m_random);
    Points after = mesh.vertices;
    if (m_random.chance(0.5)) after.array() += m_random.one_of<double>({0.01, 1e3, 1e300});
    try {
        m_solver.setAnimatedObstacle(&body, std::make_shared<const Faces>(mesh.faces),
                                     mesh.vertices, after,
                                     m_random.one_of<double>({0, 1.0 / 60.0, 1e-300, 1e9}));
    } catch (const ArgumentError&) {
    }
}

void WorldMeddler::move_rigid_body(btRigidBody& body) {
    if (m_random.chance(0.1)) return animate(body);
    if (m_random.chance(0.3)) return body.setLinearVelocity(vector(m_random, 3));
    btTransform to = random_transform(m_random, 0.7);
    const btVector3 spoilt = m_random.chance(0.05) ? numbers(m_random, 1) : to.getOrigin();
    if (!body.isStaticObject()) to.setOrigin(spoilt);  // else it damages the broadphase
    body.setWorldTransform(to);
    body.activate();
}

void WorldMeddler::meddle() {
    const int what = m_random.between(0, 13);
    if (what == 0) return add_soft_body();
    if (what == 1) return remove_soft_body();
    if (what == 2) return add_rigid_body();
    if (what == 3) return remove_rigid_body();
    if (what == 4 && !m_rigid.empty()) return move_rigid_body(*m_random.one_of(m_rigid));
    if (m_soft.empty()) return;
    btSoftBody& body = *m_random.one_of(m_soft);
    if (what <= 6) return change_nodes(body);
    if (what == 7) return move_body(body);
    if (what == 8) return push(body);
    if (what == 9) return change_settings(body);
    if (what == 10) return change_topology(body);
    if (what == 11) return anchor(body);
    if (what == 12) return put_to_sleep_or_wake(body);
    if (m_random.chance(0.5)) return set_goals(body);
    ask_the_solver(body);
}

}  // namespace cloth::test
