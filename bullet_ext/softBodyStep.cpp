#include "bullet_ext/softBodyStep.h"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bullet_ext/slidingFriction.h"
#include "bullet_ext/softAnchors.h"
#include "bullet_ext/softBodyGarment.h"

namespace cloth {

namespace {

bool differs(const btVector3& v, const float* written) {
    return v.x() != written[0] || v.y() != written[1] || v.z() != written[2];
}

void store(const btVector3& v, float* written) {
    for (int c = 0; c < 3; ++c) written[c] = v[c];
}

btVector3 restored(const float* written) {
    return {written[0], written[1], written[2]};
}

}  // namespace

/// Where the cloth is and will be after `time` seconds, and `reach` around it.
SoftBodyStep::Box SoftBodyStep::boxAhead(const ClothState& state, double time, double reach) {
    const Points ahead = state.x + time * state.v;
    const Vec3 margin = Vec3::Constant(reach);
    return {state.x.colwise().minCoeff().cwiseMin(ahead.colwise().minCoeff()).transpose() - margin,
            state.x.colwise().maxCoeff().cwiseMax(ahead.colwise().maxCoeff()).transpose() + margin};
}

SoftBodyStep::SoftBodyStep(btSoftBody& body, std::unique_ptr<const Garment> garment,
                           std::unique_ptr<Stepper> stepper, double sleep_motion,
                           bool sliding_friction)
    : m_body(body),
      m_garment(std::move(garment)),
      m_stepper(std::move(stepper)),
      m_reactions(body),
      m_sleep(body, sleep_motion),
      m_sliding_friction(sliding_friction) {
    restart();
    m_impulse = Points::Zero(body.m_nodes.size(), 3);
}

void SoftBodyStep::restart() {
    const int count = m_body.m_nodes.size();
    m_shown.stick = {};
    m_shown.x = nodePositions(m_body);
    m_shown.v.resize(count, 3);
    m_written.resize(static_cast<size_t>(count) * 6);
    for (int i = 0; i < count; ++i) {
        const btSoftBody::Node& node = m_body.m_nodes[i];
        m_shown.v.row(i) = toVec3(node.m_v);
        store(node.m_x, &m_written[static_cast<size_t>(i) * 6]);
        store(node.m_v, &m_written[static_cast<size_t>(i) * 6 + 3]);
    }
    m_cloth_step.valid = false;
}

bool SoftBodyStep::begin(double h, BulletObstacles& obstacles, double reach) {
    // A frame that took so long, or such a time scale, must not cost a thousand cloth steps.
    constexpr double kLongest = 2.0;  // s
    m_time_scale = static_cast<double>(m_body.m_cfg.timescale);
    m_world_h = h;
    m_h = std::min(h * m_time_scale, kLongest);
    m_reach = reach;
    m_result = Result();
    m_begun = m_handed_over = m_worked_on = false;
    Points expected;
    expected.swap(m_expected);
    if (m_goals) m_goals->beginStep(h);
    if (m_root) m_root->beginStep(h);
    // Nodes changed since the solver looked at them: next step.
    if (m_body.m_nodes.size() != m_shown.x.rows()) return false;
    m_result.restored_nodes = restoreNodes();
    if (!(m_h > 0.0)) {
        pause(obstacles);
        return false;
    }
    takeConstants();
    takeNodes();
    takeForces();
    takePins();
    m_box = boxAhead(m_shown, m_h, reach);
    resume(obstacles);
    obstacles.watch(m_body, m_box.low, m_box.high);
    m_expected.swap(expected);
    return m_begun = true;
}

/// Those around the nodes, ascending.
std::vector<const btCollisionObject*> SoftBodyStep::animatedNear(
    const BulletObstacles& obstacles) const {
    std::vector<const btCollisionObject*> animated;
    for (const NearObject& near : obstacles.objectsNear(m_body, m_box.low, m_box.high))
        if (near.is_animated) animated.push_back(near.object);
    return animated;
}

void SoftBodyStep::pause(const BulletObstacles& obstacles) {
    if (std::exchange(m_paused, true)) return;
    m_box = boxAhead(m_shown, 0.0, m_reach);
    m_at_pause = animatedNear(obstacles);
}

/// A character that went on without its cloth is not where it was; nor is one that was removed.
void SoftBodyStep::resume(const BulletObstacles& obstacles) {
    if (!std::exchange(m_paused, false) || m_at_pause.empty()) return;
    const std::vector<const btCollisionObject*> now = animatedNear(obstacles);
    m_result.left_behind =
        std::none_of(m_at_pause.begin(), m_at_pause.end(), [&](const btCollisionObject* object) {
            return std::find(now.begin(), now.end(), object) != now.end();
        });
}

bool SoftBodyStep::isIndependent(const BulletObstacles& obstacles) const {
    if (!m_stepper->is_independent()) return false;
    for (int a = 0; a < m_body.m_anchors.size(); ++a)
        if (isDynamic(*m_body.m_anchors[a].m_body)) return false;
    return !obstacles.anyDynamicNear(m_body, m_box.low, m_box.high);
}

SoftBodyStep::Result SoftBodyStep::end(BulletObstacles& obstacles) {
    if (!m_begun) return m_result;
    followAnchors();
    m_shown = endOfWorldStep();
    writeNodes();
    measureDepth(obstacles);
    m_result.stretched_anchor = stretchedAnchor();
    m_result.idle_anchor = idleAnchor(m_body);
    handOver(obstacles);
    m_cloth_step.begin -= m_h;
    m_sleep.afterStep(m_shown.x, m_world_h, obstacles, m_box.low, m_box.high);
    return m_result;
}

void SoftBodyStep::handOver(BulletObstacles& obstacles) {
    if (!m_begun || m_handed_over) return;
    m_handed_over = true;
    m_reactions.apply(m_h, obstacles.solidsNear(m_body, m_box.low, m_box.high, {m_world_h, 0.0}));
}

bool SoftBodyStep::sleepsOn(const BulletObstacles& obstacles) {
    if (m_sleep.sleepsOn(obstacles)) return true;
    // It wakes where its nodes are, at rest or with what the user gave them.
    m_shown.v.setZero();
    for (int i = 0; i < m_body.m_nodes.size() && i < m_shown.v.rows(); ++i)
        m_shown.v.row(i) = toVec3(m_body.m_nodes[i].m_v);
    m_cloth_step.valid = false;
    return false;
}

/// What btSoftBody::predictMotion() prepares and other parts of Bullet rely on.
void SoftBodyStep::takeConstants() {
    if (m_body.m_bUpdateRtCst) {
        m_body.m_bUpdateRtCst = false;
        m_body.updateConstants();
        m_body.m_fdbvt.clear();
        if (m_body.m_cfg.collisions & btSoftBody::fCollision::VF_SS) m_body.initializeFaceTree();
    }
    btSoftBody::SolverState& sst = m_body.m_sst;
    sst.sdt = static_cast<btScalar>(m_h);
    sst.isdt = 1 / sst.sdt;
    sst.velmrg = sst.sdt * 3;
    sst.radmrg = m_body.getCollisionShape()->getMargin();
    sst.updmrg = sst.radmrg * static_cast<btScalar>(0.25);
    m_body.m_rcontacts.clear();
    m_body.m_scontacts.clear();
}

int SoftBodyStep::restoreNodes() {
    int count = 0;
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = m_body.m_nodes[i];
        const float* written = &m_written[static_cast<size_t>(i) * 6];
        if (!isFinite(node.m_f)) node.m_f.setZero();
        if (isFinite(node.m_x) && isFinite(node.m_v)) continue;
        node.m_x = restored(written);
        node.m_v = restored(written + 3);
        ++count;
    }
    return count;
}

void SoftBodyStep::takeNodes() {
    const std::vector<char>& pinned = m_garment->is_pinned();
    bool all_moved = true;
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = m_body.m_nodes[i];
        const float* written = &m_written[static_cast<size_t>(i) * 6];
        const bool moved = differs(node.m_x, written), pushed = differs(node.m_v, written + 3);
        node.m_q = node.m_x;
        if (pinned[static_cast<size_t>(i)]) continue;
        all_moved = all_moved && moved;
        if (!moved && !pushed) continue;
        if (moved) m_shown.x.row(i) = toVec3(node.m_x);
        if (pushed) m_shown.v.row(i) = toVec3(node.m_v);
        m_cloth_step.valid = false;
    }
    if (all_moved && !m_cloth_step.valid) placePins();
}

/// Who moves the whole body, as translate() does, puts its pins elsewhere, too: they do not drag
/// the cloth there.
void SoftBodyStep::placePins() {
    for (const int pin : m_garment->pins()) {
        const btSoftBody::Node& node = m_body.m_nodes[pin];
        const bool is_anchored = node.m_im > 0;
        if (!is_anchored) m_shown.x.row(pin) = toVec3(node.m_x);
    }
}

/// Wind, by Bullet's aerodynamic models; as in Bullet they see the velocity with gravity's part.
/// It is the velocity that the next cloth step starts with, with all that the world steps before
/// this one gave it: drag takes no more than the velocity that it sees, but the drags of many short
/// world steps would together turn it round if each of them saw the same.
void SoftBodyStep::takeWind() {
    if (!(m_body.m_cfg.kLF > 0) && !(m_body.m_cfg.kDG > 0)) return;
    const Points& start = m_cloth_step.valid ? m_cloth_step.to.v : m_shown.v;
    std::vector<btVector3> velocities, forces;
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = m_body.m_nodes[i];
        velocities.push_back(node.m_v);
        forces.push_back(node.m_f);
        node.m_v = toBullet(Vec3(start.row(i) + static_cast<double>(node.m_im) * m_impulse.row(i)));
    }
    m_body.addVelocity(m_body.m_worldInfo->m_gravity * m_body.m_sst.sdt);
    m_body.applyForces();
    keepWindFromGiving(forces);
    for (int i = 0; i < m_body.m_nodes.size(); ++i)
        m_body.m_nodes[i].m_v = velocities[static_cast<size_t>(i)];
}

/// Air slows down what moves through it, and turns it, but gives it no energy of motion relative to
/// the air. Lift of finite steps does: it is taken for as much as gives none.
/// @param before  forces on the nodes without wind (N)
void SoftBodyStep::keepWindFromGiving(const std::vector<btVector3>& before) {
    if (m_body.m_cfg.kPR != 0 || m_body.m_cfg.kVC != 0) return;  // these give, too
    const Vec3 air = toVec3(m_body.getWindVelocity());
    double work = 0.0, kinetic = 0.0;  // J: of the change times the velocity; of the change alone
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        const btSoftBody::Node& node = m_body.m_nodes[i];
        if (!(node.m_im > 0) || !isFinite(node.m_f)) continue;
        const Vec3 impulse = m_h * toVec3(node.m_f - before[static_cast<size_t>(i)]);
        work += impulse.dot(toVec3(node.m_v) - air);
        kinetic += 0.5 * static_cast<double>(node.m_im) * impulse.squaredNorm();
    }
    if (!(work + kinetic > 0.0)) return;
    const auto kept = static_cast<btScalar>(std::max(0.0, -work / kinetic));
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        btVector3& force = m_body.m_nodes[i].m_f;
        force = before[static_cast<size_t>(i)] + kept * (force - before[static_cast<size_t>(i)]);
    }
}

void SoftBodyStep::takeForces() {
    takeWind();
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = m_body.m_nodes[i];
        if (node.m_im > 0 && isFinite(node.m_f)) m_impulse.row(i) += m_h * toVec3(node.m_f);
        node.m_f.setZero();
    }
}

void SoftBodyStep::takePins() {
    const std::vector<int>& pins = m_garment->pins();
    const auto count = static_cast<Eigen::Index>(pins.size());
    m_pins_before.resize(count, 3);
    m_pins_after.resize(count, 3);
    for (Eigen::Index p = 0; p < count; ++p) {
        const btSoftBody::Node& node = m_body.m_nodes[pins[static_cast<size_t>(p)]];
        m_pins_before.row(p) = m_shown.x.row(pins[static_cast<size_t>(p)]);
        m_pins_after.row(p) = toVec3(node.m_x) + m_h * toVec3(node.m_v);
    }
    followAnchors();
}

/// Puts anchored nodes where their bodies are.
void SoftBodyStep::followAnchors() {
    const std::vector<int>& pins = m_garment->pins();
    const auto put = [&](int node, const btVector3& place) {
        const auto pin = std::lower_bound(pins.begin(), pins.end(), node);
        if (pin != pins.end() && *pin == node && isFinite(place))
            m_pins_after.row(pin - pins.begin()) = toVec3(place);
    };
    for (int a = 0; a < m_body.m_anchors.size(); ++a) {
        const btSoftBody::Anchor& anchor = m_body.m_anchors[a];
        put(static_cast<int>(anchor.m_node - &m_body.m_nodes[0]),
            anchor.m_body->getWorldTransform() * anchor.m_local);
    }
    for (const LinkAnchor& anchor : linkAnchors(m_body)) put(anchor.node, anchor.place());
}

Points SoftBodyStep::pinsAt(double time) const {
    if (time <= m_h) return m_pins_before + (time / m_h) * (m_pins_after - m_pins_before);
    // Beyond the world step pins go on as they did in the same part of the last cloth step.
    const double rest = (time - m_h) / (m_cloth_step.begin + m_cloth_step.length - m_h);
    return m_pins_after + std::min(rest, 1.0) * m_pins_drift;
}

Boundary SoftBodyStep::boundaryOfClothStep(BulletObstacles& obstacles) {
    const auto& [low, high] = m_cloth_box;
    Boundary boundary;
    boundary.gravity = toVec3(m_body.m_worldInfo->m_gravity);
    boundary.pin_targets = pinsAt(m_cloth_step.begin + m_cloth_step.length);
    const TimeSpan span = {m_cloth_step.begin / m_time_scale, m_cloth_step.length / m_time_scale};
    std::vector<const btCollisionObject*> owners;
    boundary.obstacles = obstacles.near(m_body, low, high, span, &owners);
    boundary.trees = obstacles.trees();
    if (m_garment->has_goals() && m_goals) {
        boundary.goals = m_goals->during(span);
        m_result.without_goals = !m_goals->given();
    }
    m_solids = obstacles.solidsNear(m_body, low, high, span);
    m_pinched.makeRoom(*m_garment, m_cloth_step.from, m_solids, owners, boundary);
    if (!m_impulse.isZero(0.0)) {
        boundary.accelerations = m_impulse / m_cloth_step.length;
        for (int i = 0; i < m_body.m_nodes.size(); ++i)
            boundary.accelerations.row(i) *= static_cast<double>(m_body.m_nodes[i].m_im);
        m_impulse.setZero();
    }
    pullSoftAnchors(m_body, *m_garment, m_cloth_step.from, m_cloth_step.length, m_h,
                    boundary.accelerations);
    m_worked_on = m_worked_on || boundary.accelerations.size() > 0 || m_garment->has_goals() ||
                  (m_root && m_root->given()) || m_pins_before != m_pins_after ||
                  !obstaclesStand(boundary);
    addExpected(boundary.accelerations);
    return boundary;
}

/// What other cloth does to it in this cloth step, from what it did in the last one.
void SoftBodyStep::addExpected(Points& accelerations) {
    if (m_expected.rows() != m_garment->vertex_count()) return;
    const VectorX masses = massRatio(m_body, *m_garment) * m_garment->masses();
    if (accelerations.rows() == 0) accelerations.setZero(m_expected.rows(), 3);
    for (Eigen::Index i = 0; i < m_expected.rows(); ++i)
        if (masses[i] > 0.0)
            accelerations.row(i) += m_expected.row(i) / (masses[i] * m_cloth_step.length);
    m_expected.resize(0, 3);
}

/// The next cloth step starts where the last one ended, or where the nodes are.
void SoftBodyStep::startClothStep(bool first_of_step) {
    const bool goes_on = m_cloth_step.valid;
    m_pins_drift = goes_on && first_of_step ? Points(m_pins_before - m_pins_at_cloth_step)
                                            : Points::Zero(m_pins_before.rows(), 3);
    m_pins_at_cloth_step = m_pins_after;
    m_continues = goes_on && !m_pushed;
    m_pushed = false;
    m_cloth_step.from = goes_on ? m_cloth_step.to : m_shown;
    m_cloth_step.begin = goes_on ? m_cloth_step.begin + m_cloth_step.length : 0.0;
    m_cloth_step.length = clothStepLength();
    if (!m_prepared) m_stepper->prepare(m_cloth_step.length);
    m_prepared = true;
    m_cloth_step.valid = true;
    const Points pins_now = pinsAt(m_cloth_step.begin);
    const std::vector<int>& pins = m_garment->pins();
    for (size_t p = 0; p < pins.size(); ++p)
        m_cloth_step.from.x.row(pins[p]) = pins_now.row(static_cast<Eigen::Index>(p));
}

double SoftBodyStep::clothStepLength() const {
    // Contacts move cloth by millimetres in a step, however short it is.
    constexpr double kShortest = 1e-3, kNearly = 0.99 * kShortest;  // s
    const double own = looksAhead() ? m_stepper->fixed_dt() : m_h - m_cloth_step.begin;
    if (!m_stepper->accepts_any_dt() || m_meeting || hangsOnDynamicBody()) return own;
    if (own < kNearly) return std::max(kShortest, m_rate * m_h);
    // A step of its own length that is nearly as long is better: a network is made for it.
    return m_rate > 1 && m_rate * m_h > 1.5 * own ? m_rate * m_h : own;
}

bool SoftBodyStep::hangsOnDynamicBody() const {
    for (int a = 0; a < m_body.m_anchors.size(); ++a)
        if (isHardAnchor(m_body.m_anchors[a]) && isDynamic(*m_body.m_anchors[a].m_body))
            return true;
    return false;
}

/// A body that hangs on the cloth, and is pulled by it, cannot be foreseen; nor can other cloth.
bool SoftBodyStep::looksAhead() const {
    if (!(m_stepper->fixed_dt() > 0.0)) return false;
    return !m_stepper->accepts_any_dt() || !(m_meeting || hangsOnDynamicBody());
}

Pose SoftBodyStep::carryingMotion() const {
    Pose motion = Pose::Identity();
    if (m_root && m_root->given()) return m_root->motion();
    const auto mean = [](const Points& x) -> Vec3 { return x.colwise().mean(); };
    if (m_goals && m_goals->given()) {
        const SkinGoals goals = m_goals->during({0.0, m_world_h});
        motion.translation() = mean(goals.x1) - mean(goals.x0);
    } else if (m_pins_after.rows() > 0) {
        motion.translation() = mean(m_pins_after) - mean(m_pins_before);
    }
    return motion;
}

void SoftBodyStep::carry(double h) {
    m_time_scale = static_cast<double>(m_body.m_cfg.timescale);
    m_world_h = h;
    m_h = h * m_time_scale;
    m_result = Result();
    m_begun = false;
    if (m_goals) m_goals->beginStep(h);
    if (m_root) m_root->beginStep(h);
    if (m_body.m_nodes.size() != m_shown.x.rows() || !(m_h > 0.0)) return;
    restoreNodes();
    takeConstants();
    takeNodes();
    takePins();
    for (int i = 0; i < m_body.m_nodes.size(); ++i) m_body.m_nodes[i].m_f.setZero();
    m_impulse.setZero();
    const Points before = m_shown.x;
    m_shown.x = transformed(before, carryingMotion());
    const std::vector<int>& pins = m_garment->pins();
    for (size_t p = 0; p < pins.size(); ++p)
        m_shown.x.row(pins[p]) = m_pins_after.row(static_cast<Eigen::Index>(p));
    m_shown.v = (m_shown.x - before) / m_h;
    m_shown.stick = {};
    m_cloth_step.valid = false;
    m_depth = 0.0;
    writeNodes();
}

bool SoftBodyStep::beginClothStep(BulletObstacles& obstacles) {
    if (!m_begun) return false;
    const double end = m_h * (1.0 - 1e-3);  // float time steps must not cost an extra cloth step
    if (m_cloth_step.valid && m_cloth_step.begin + m_cloth_step.length >= end) return false;
    startClothStep(m_result.steps == 0);
    m_cloth_box = boxAhead(m_cloth_step.from, m_cloth_step.length, m_reach);
    m_boundary = boundaryOfClothStep(obstacles);
    carryClothStep();
    const bool now =
        std::abs(m_cloth_step.begin) + std::abs(m_cloth_step.length - m_h) < 1e-3 * m_h;
    m_hang = now && m_anchored.begin(m_body, *m_garment, m_cloth_step.length);
    return true;
}

/// What of its root's motion the cloth does not feel.
void SoftBodyStep::carryClothStep() {
    m_carried = m_cloth_step.from;
    if (!m_root) return;
    const Pose motion =
        m_root->carry({m_cloth_step.begin / m_time_scale, m_cloth_step.length / m_time_scale});
    if (motion.matrix() == Pose::Identity().matrix()) return;
    carryStart(motion, m_boundary, m_carried);
    m_stepper->moved(m_cloth_step.from.x, m_carried.x, motion.linear());
}

void SoftBodyStep::solve() {
    const ClothState& from = m_carried;
    StageTimes times;
    do {
        m_solved = from;
        if (m_deadline.is_set()) m_stepper->set_max_ms(std::max(1e-3, m_deadline.left()));
        m_stepper->set_most_residual(m_hang ? m_anchored.mostResidual()
                                            : std::numeric_limits<double>::infinity());
        if (m_hang && m_anchored.knowsStart()) m_stepper->start_next_at(m_anchored.nextStart());
        m_report = m_stepper->step(m_boundary, m_cloth_step.length, m_solved);
        m_report.finite = m_report.finite && fitsFloats(m_solved.x) && fitsFloats(m_solved.v);
        times += m_report.times;
    } while (m_hang && m_anchored.tryAgain(*m_stepper, from, m_boundary, m_solved, m_report));
    m_report.times = times;
}

void SoftBodyStep::endClothStep(BulletObstacles& obstacles) {
    const ClothState& from = m_carried;
    if (m_hang && m_report.finite) m_anchored.place(m_solved);
    if (m_report.finite)
        m_cloth_step.to = std::move(m_solved);
    else
        m_cloth_step.to = m_cloth_step.from;
    m_cloth_step.to.time = from.time + m_cloth_step.length;
    // Impulses of friction are handed on by themselves; where there is no body, it is in the
    // balance.
    const bool alone = m_solids.empty();
    if (alone) slowDown(obstacles);
    if (m_report.finite)
        m_reactions.collect({*m_garment, *m_stepper, m_boundary, from, m_cloth_step.to,
                             m_cloth_step.length, m_solids, m_pinched, m_continues,
                             m_hang ? &m_anchored : nullptr});
    for (const btRigidBody* body : m_reactions.heldBodies()) obstacles.follow(*body);
    if (!alone) slowDown(obstacles);
    m_boundary = Boundary();  // large, where obstacles are meshes
    m_result.failed_steps += m_report.finite ? 0 : 1;
    m_result.caught_nodes = std::max(m_result.caught_nodes, m_pinched.caught());
    m_result.calmed |= m_reactions.calmed();
    m_result.unbalanced |= m_reactions.unbalanced();
    ++m_result.steps;
}

/// Bullet's friction and damping, which it gives per world step.
void SoftBodyStep::slowDown(BulletObstacles& obstacles) {
    const auto& [low, high] = m_cloth_box;
    if (m_sliding_friction && m_report.finite) {
        const double end = (m_cloth_step.begin + m_cloth_step.length) / m_time_scale;
        applySlidingFriction(m_body,
                             {*m_garment, *m_stepper, obstacles.slidingNear(m_body, low, high, end),
                              m_cloth_step.length, m_h, m_cloth_step.from, m_cloth_step.to});
    }
    const double damping = std::min(static_cast<double>(m_body.m_cfg.kDP), 1.0);
    if (damping > 0.0) m_cloth_step.to.v *= std::pow(1.0 - damping, m_cloth_step.length / m_h);
}

bool SoftBodyStep::endsWithWorldStep() const {
    const double ahead = m_cloth_step.begin + m_cloth_step.length - m_h;
    return m_begun && m_cloth_step.valid && std::abs(ahead) <= 1e-3 * m_cloth_step.length;
}

ClothState SoftBodyStep::endOfWorldStep() const {
    if (!m_begun) return m_shown;
    const double s = std::clamp((m_h - m_cloth_step.begin) / m_cloth_step.length, 0.0, 1.0);
    ClothState shown;
    if (s > 1.0 - 1e-3) {
        shown = m_cloth_step.to;
    } else {
        shown.x = m_cloth_step.from.x + s * (m_cloth_step.to.x - m_cloth_step.from.x);
        shown.v = m_cloth_step.from.v + s * (m_cloth_step.to.v - m_cloth_step.from.v);
        shown.time = m_cloth_step.from.time + s * m_cloth_step.length;
    }
    const std::vector<int>& pins = m_garment->pins();
    for (size_t p = 0; p < pins.size(); ++p)
        shown.x.row(pins[p]) = m_pins_after.row(static_cast<Eigen::Index>(p));
    return shown;
}

void SoftBodyStep::takeContact(const Points& x, const Points& v, double depth) {
    m_cloth_step.to.x = x;
    m_cloth_step.to.v = v;
    m_pushed = true;
    m_pushed_depth = depth;
}

/// Where the cloth step ends with the world step, and the cloth saw all as it is shown, its stepper
/// has measured already: edges and faces, too.
void SoftBodyStep::measureDepth(BulletObstacles& obstacles) {
    const double ahead = m_cloth_step.begin + m_cloth_step.length - m_h;
    m_depth = m_report.max_penetration;
    if (std::abs(ahead) > 1e-3 * m_cloth_step.length || m_pinched.movesSolids() ||
        m_reactions.heldBack())
        m_depth = obstacles.deepest(m_body, m_shown.x, m_garment->is_pinned());
    if (m_pushed) m_depth = std::max(m_depth, m_pushed_depth);
}

/// An edge of twice its length is torn cloth.
int SoftBodyStep::stretchedAnchor() const {
    constexpr double kTorn = 2.0;
    if (m_body.m_anchors.size() == 0) return -1;
    for (const auto& [a, b] : m_garment->edges()) {
        const double rest =
            (m_garment->rest().vertices.row(a) - m_garment->rest().vertices.row(b)).norm();
        if ((m_shown.x.row(a) - m_shown.x.row(b)).norm() <= kTorn * rest) continue;
        for (int k = 0; k < m_body.m_anchors.size(); ++k) {
            const int node = static_cast<int>(m_body.m_anchors[k].m_node - &m_body.m_nodes[0]);
            if (isHardAnchor(m_body.m_anchors[k]) && (node == a || node == b)) return node;
        }
    }
    return -1;
}

void SoftBodyStep::writeNodes() {
    const std::vector<char>& pinned = m_garment->is_pinned();
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = m_body.m_nodes[i];
        float* written = &m_written[static_cast<size_t>(i) * 6];
        node.m_x = toBullet(Vec3(m_shown.x.row(i)));
        node.m_vn = node.m_v;
        // The velocity of a node without mass is the user's command and stays, as in Bullet.
        if (!pinned[static_cast<size_t>(i)] || node.m_im > 0)
            node.m_v = toBullet(Vec3(m_shown.v.row(i)));
        store(node.m_x, written);
        store(node.m_v, written + 3);
    }
    m_body.updateNormals();
    m_body.updateNodeTree(/*use_velocity=*/false, /*margin=*/true);
    m_body.updateFaceTree(/*use_velocity=*/false, /*margin=*/true);
    m_body.m_ndbvt.optimizeIncremental(1);
    m_body.m_fdbvt.optimizeIncremental(1);
    m_body.updateBounds();
    m_body.updatePose();
}

}  // namespace cloth
