#include "bullet_ext/bulletClothStepper.h"

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "bullet_ext/bulletHulls.h"
#include "data/errors.h"

namespace cloth {

namespace {

constexpr double kExploded = 100.0;  ///< cloth that moved farther in one step has exploded (m)

void validate(const BulletClothSettings& settings) {
    const auto check = [](const char* field, double value, double low, double high) {
        if (!(value >= low && value <= high))
            throw ArgumentError(std::string("BulletClothSettings.") + field,
                                "is " + std::to_string(value),
                                "use " + std::to_string(low) + " to " + std::to_string(high));
    };
    check("substep_dt", settings.substep_dt, 1e-4, 0.1);
    check("voxel", settings.voxel, 1e-3, 0.25);
    check("hull_margin", settings.hull_margin, 0.0, 0.05);
    check("segments", settings.segments, 1, 1000);
    check("cloth.iterations", settings.cloth.iterations, 1, 1000);
    check("cloth.margin", settings.cloth.margin, 1e-4, 0.25);
}

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
    void load(const ClothState& state) { loadState(state, *m_cloth); }
    void store(ClothState& state) const { storeState(*m_cloth, state); }

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
    btDefaultSoftBodySolver m_solver;
    btSoftRigidDynamicsWorld m_world;
    std::unique_ptr<btSoftBody> m_cloth;
    BulletHulls m_hulls;
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
    report.residual = report.max_penetration = std::numeric_limits<double>::quiet_NaN();
    const auto count = m_garment.vertex_count();
    report.finite =
        dt > 0.0 && state.x.rows() == count && state.v.rows() == count && state.x.allFinite() &&
        state.v.allFinite() &&
        boundary.pin_targets.rows() == static_cast<long>(m_garment.pins().size()) &&
        boundary.pin_targets.allFinite() &&
        (boundary.accelerations.size() == 0 ||
         (boundary.accelerations.rows() == count && boundary.accelerations.allFinite()));
    if (!report.finite) return report;
    const auto start = std::chrono::steady_clock::now();
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
    ClothState next = state;
    m_world->store(next);
    for (size_t p = 0; p < m_garment.pins().size(); ++p)
        next.x.row(m_garment.pins()[p]) = boundary.pin_targets.row(static_cast<Eigen::Index>(p));
    next.time += dt;
    report.iterations = substeps * m_settings.cloth.iterations;
    report.finite = next.x.allFinite() && next.v.allFinite() &&
                    (next.x - state.x).cwiseAbs().maxCoeff() < kExploded;
    if (report.finite)
        state = std::move(next);
    else
        m_world.reset();  // numbers that are not finite have spread to Bullet's trees
    report.times.solve =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace cloth
