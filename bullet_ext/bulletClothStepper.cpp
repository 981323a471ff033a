#include "bullet_ext/bulletClothStepper.h"

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include "bullet_ext/bulletHulls.h"
#include "data/core/check_range.h"

namespace cloth {

namespace {

constexpr double kFarthestVertex = 1e6;  ///< floats are too coarse for cloth out there (m)
constexpr double kExploded = 100.0;      ///< cloth that moved farther in one step has exploded (m)

void validate(const BulletClothSettings& settings) {
    check_range("BulletClothSettings.substep_dt", settings.substep_dt, 1e-4, 0.1);
    check_range("BulletClothSettings.voxel", settings.voxel, 1e-3, 0.25);
    check_range("BulletClothSettings.hull_margin", settings.hull_margin, 0.0, 0.05);
    check_range("BulletClothSettings.segments", settings.segments, 1, 1000);
    checkSoftBodySettings(settings.cloth);
}

bool isFinite(const Obstacle& o) {
    return o.x0.allFinite() && o.x1.allFinite() && o.x0.rows() == o.x1.rows() &&
           o.pose0.matrix().allFinite() && o.pose1.matrix().allFinite() &&
           o.half_extents.allFinite() && std::isfinite(o.radius) && std::isfinite(o.friction);
}

bool isUsable(const Garment& garment, const Boundary& boundary, double dt,
              const ClothState& state) {
    const Eigen::Index count = garment.vertex_count();
    const auto pins = static_cast<Eigen::Index>(garment.pins().size());
    const Points& push = boundary.accelerations;
    return std::isfinite(dt) && dt > 0.0 && state.x.rows() == count && state.v.rows() == count &&
           state.x.allFinite() && state.v.allFinite() &&
           state.x.cwiseAbs().maxCoeff() < kFarthestVertex && boundary.gravity.allFinite() &&
           boundary.pin_targets.rows() == pins && boundary.pin_targets.allFinite() &&
           (push.size() == 0 || (push.rows() == count && push.allFinite())) &&
           std::all_of(boundary.obstacles.begin(), boundary.obstacles.end(), isFinite);
}

bool sameBits(const Points& a, const Points& b) {
    return a.rows() == b.rows() &&
           std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<size_t>(a.size())) == 0;
}

/// Bullet's solver, given its contacts in an order that does not depend on what happened before.
class OrderedSolver : public btDefaultSoftBodySolver {
 public:
    void solveConstraints(btScalar dt) override {
        for (int i = 0; i < m_softBodySet.size(); ++i)
            m_softBodySet[i]->m_rcontacts.quickSort(
                [](const btSoftBody::RContact& a, const btSoftBody::RContact& b) {
                    if (a.m_node != b.m_node) return a.m_node < b.m_node;
                    return a.m_cti.m_colObj->getUserIndex() < b.m_cti.m_colObj->getUserIndex();
                });
        btDefaultSoftBodySolver::solveConstraints(dt);
    }
};

}  // namespace

/// Everything that lives in Bullet.
class BulletClothStepper::World {
 public:
    World(const Garment& garment, const BulletClothSettings& settings)
        : m_garment(garment),
          m_dispatcher(&m_config),
          m_world(&m_dispatcher, &m_broadphase, &m_rigid_solver, &m_config, &m_solver) {
        btSoftBodyWorldInfo& info = m_world.getWorldInfo();
        info.m_dispatcher = &m_dispatcher;
        info.m_broadphase = &m_broadphase;
        info.m_sparsesdf.Initialize();  // sets the cells to 0.25 m, so it comes first
        info.m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(settings.voxel));
        info.m_sparsesdf.Reset();
        m_cloth.reset(createGarmentSoftBody(info, garment, settings.cloth));
        m_cloth->setActivationState(DISABLE_DEACTIVATION);
        m_world.addSoftBody(m_cloth.get());
    }
    ~World() {
        m_hulls.removeFrom(m_world);
        m_world.removeSoftBody(m_cloth.get());
    }

    BulletHulls& hulls() { return m_hulls; }
    btSoftRigidDynamicsWorld& world() { return m_world; }

    void setGravity(const Vec3& gravity) {
        m_world.setGravity(toBullet(gravity));
        m_world.getWorldInfo().m_gravity = toBullet(gravity);
    }
    /// A state that this world has made goes on with Bullet's own velocities.
    void load(const ClothState& state) {
        const bool goes_on = sameBits(state.x, m_last.x) && sameBits(state.v, m_last.v);
        loadState(goes_on ? ClothState{state.x, m_node_velocities, state.time} : state, *m_cloth);
    }
    /// The state after dt seconds; pins land exactly.
    ClothState stateAfter(const ClothState& before, const Boundary& boundary, double dt) {
        ClothState state;
        storeState(*m_cloth, state);
        m_node_velocities = state.v;
        for (size_t p = 0; p < m_garment.pins().size(); ++p)
            state.x.row(m_garment.pins()[p]) =
                boundary.pin_targets.row(static_cast<Eigen::Index>(p));
        state.v = (state.x - before.x) / dt;
        state.time = before.time + dt;
        m_last = state;
        return state;
    }
    /// Of the nodes that Bullet found in contact, the deepest below a hull (m).
    double deepest() {
        double depth = 0.0;
        for (int i = 0; i < m_cloth->m_rcontacts.size(); ++i) {
            const btSoftBody::RContact& contact = m_cloth->m_rcontacts[i];
            const btCollisionObject& hull = *contact.m_cti.m_colObj;
            btVector3 normal;
            const btScalar distance = m_world.getWorldInfo().m_sparsesdf.Evaluate(
                hull.getWorldTransform().invXform(contact.m_node->m_x), hull.getCollisionShape(),
                normal, 0);
            depth = std::max(depth, -static_cast<double>(distance));
        }
        return depth;
    }

    void sendPins(const Points& targets, double dt) {
        const std::vector<int>& pins = m_garment.pins();
        for (size_t p = 0; p < pins.size(); ++p) {
            btSoftBody::Node& node = m_cloth->m_nodes[pins[p]];
            const Vec3 target = targets.row(static_cast<Eigen::Index>(p));
            node.m_v = toBullet(Vec3((target - toVec3(node.m_x)) / dt));
        }
    }
    void push(const Points& accelerations) {
        for (int i = 0; i < static_cast<int>(accelerations.rows()); ++i)
            m_cloth->addForce(toBullet(Vec3(m_garment.masses()[i] * accelerations.row(i))), i);
    }
    void subStep(double h) {
        // Without sub-steps of its own: Bullet reads kinematic bodies once per call.
        m_world.stepSimulation(static_cast<btScalar>(h), 0);
        m_world.getWorldInfo().m_sparsesdf.GarbageCollect();
    }

 private:
    const Garment& m_garment;
    btSoftBodyRigidBodyCollisionConfiguration m_config;
    btCollisionDispatcher m_dispatcher;
    btDbvtBroadphase m_broadphase;
    btSequentialImpulseConstraintSolver m_rigid_solver;
    OrderedSolver m_solver;
    btSoftRigidDynamicsWorld m_world;
    std::unique_ptr<btSoftBody> m_cloth;
    BulletHulls m_hulls;
    ClothState m_last;         ///< what stateAfter() returned last
    Points m_node_velocities;  ///< |V| x 3 (m/s): Bullet's own at that time
};

BulletClothSettings BulletClothSettings::shipped(int iterations) {
    BulletClothSettings settings;
    settings.cloth.iterations = iterations;
    settings.cloth.margin = 0.01;
    if (iterations != 10) settings.name = "bullet-" + std::to_string(iterations);
    return settings;
}

BulletClothSettings BulletClothSettings::fine() {
    BulletClothSettings settings;
    settings.name = "bullet-fine";
    settings.substep_dt = 1.0 / 240.0;
    settings.cloth.iterations = 5;
    return settings;
}

BulletClothStepper::BulletClothStepper(const Garment& garment, BulletClothSettings settings,
                                       std::vector<BodySegment> segments)
    : m_garment(garment), m_settings(std::move(settings)), m_segments(std::move(segments)) {
    validate(m_settings);
}

BulletClothStepper::~BulletClothStepper() = default;

StepReport BulletClothStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    StepReport report;
    report.finite = isUsable(m_garment, boundary, dt, state);
    if (!report.finite) return report;
    const auto start = std::chrono::steady_clock::now();
    run(boundary, dt, state, report);
    report.times.solve =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return report;
}

void BulletClothStepper::run(const Boundary& boundary, double dt, ClothState& state,
                             StepReport& report) {
    if (!m_world) m_world = std::make_unique<World>(m_garment, m_settings);
    m_world->load(state);
    m_world->setGravity(boundary.gravity);
    m_world->hulls().match(boundary.obstacles, m_segments, m_settings, m_world->world());
    m_world->hulls().moveTo(0.0, /*jump=*/true);
    m_world->sendPins(boundary.pin_targets, dt);
    const int substeps = std::max(1, static_cast<int>(std::lround(dt / m_settings.substep_dt)));
    for (int s = 1; s <= substeps; ++s) {
        m_world->push(boundary.accelerations);
        m_world->hulls().moveTo(static_cast<double>(s) / substeps);
        m_world->subStep(dt / substeps);
    }
    report.iterations = substeps * m_settings.cloth.iterations;
    report.max_penetration = m_world->deepest();
    ClothState next = m_world->stateAfter(state, boundary, dt);
    report.finite = next.x.allFinite() && next.v.allFinite() &&
                    std::isfinite(report.max_penetration) &&
                    (next.x - state.x).cwiseAbs().maxCoeff() < kExploded;
    if (report.finite)
        state = std::move(next);
    else
        m_world.reset();  // numbers that are not finite have spread to Bullet's trees
}

}  // namespace cloth
