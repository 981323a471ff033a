#include "bullet_ext/twoWayCoupling.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bullet_ext/softBodyGarment.h"

namespace cloth {

namespace {

// Contacts keep cloth at 4 mm; points a little farther carry none of the load.
constexpr double kTouch = 5e-3;  // m
// Cloth between two solids is this near to both, at least where it is deepest.
constexpr double kPinch = 2e-2;  // m
// Taut cloth accelerates bodies by no more.
constexpr double kTaut = 100.0;  // m/s^2

/// Cloth spins no body faster than this per cloth step, whatever the lever: pins are extrapolated
/// over a cloth step, and farther than that the extrapolation amplifies the spin.
Vec3 limitedTurn(const Vec3& turning, const Vec3& change, double length) {
    constexpr double kTurn = 0.3;  // rad
    const double limit = std::max(turning.norm(), kTurn / length);
    const double speed = (turning + change).norm();
    return speed > limit ? Vec3((limit / speed) * (turning + change) - turning) : change;
}

/// A node's change of velocity by other things than gravity and node forces.
Vec3 changeByOthers(const ClothStep& step, Eigen::Index node) {
    Vec3 change = step.to.v.row(node) - step.from.v.row(node);
    change -= step.length * step.boundary.gravity;
    if (step.boundary.accelerations.size())
        change -= step.length * step.boundary.accelerations.row(node).transpose();
    return change;
}

/// Velocity that a body got by moving with the cloth.
Vector6 changeByMoving(const ClothStep& step, const btRigidBody& body) {
    if (!step.anchored) return Vector6::Zero();
    return step.anchored->changeOf(body);
}

}  // namespace

void TwoWayCoupling::collect(const ClothStep& step) {
    forgetAbsent(step.near);
    m_mass_ratio = massRatio(m_body, step.garment);
    m_masses = m_mass_ratio * step.garment.masses();
    for (int i = 0; i < m_body.m_nodes.size(); ++i)
        if (!(m_body.m_nodes[i].m_im > 0)) m_masses[i] = 0.0;
    for (auto& entry : m_accounts) {
        entry.second.taken.setZero();
        entry.second.nodes.clear();
        entry.second.meeting = 0.0;
        entry.second.anchored = false;
        entry.second.lift = 0.0;
        entry.second.sides = {};
    }
    m_calmed = m_held_back = m_unbalanced = false;
    m_held_bodies.clear();
    m_floats = floatsFreely(m_body, step) && allSolidsKnown(step);
    if (step.near.empty() && m_body.m_anchors.size() == 0 && linkAnchors(m_body).empty()) {
        m_accounts.clear();
        balanceAlone(step);
        return;
    }
    m_internal_known = step.stepper.internal_forces(step.to.x, m_internal);
    if (m_internal_known) m_internal *= m_mass_ratio;
    findHolders(step);
    findFreeVelocities(step);
    moveAnchored(step);
    calmContacts(step, m_touches, m_free);
    capSpeeds(step, m_touches, m_free);
    const bool held = std::any_of(m_holder.begin(), m_holder.end(),
                                  [](const btRigidBody* body) { return body != nullptr; });
    if (held) {
        findOwners(step);
        findImpulses(step);
    } else if (m_floats) {
        keepMomentum(step);
    }
    for (auto it = m_accounts.begin(); it != m_accounts.end();) {
        closeSides(*it->first, it->second);
        settle(step, *it->first, it->second);
        const bool done = it->second.nodes.empty() && it->second.planned.norm() < 1e-12;
        it = done ? m_accounts.erase(it) : std::next(it);
    }
    balanceEnergy(step);
}

/// Nothing around the cloth can be pushed: what its stepper made from nothing is still taken away.
void TwoWayCoupling::balanceAlone(const ClothStep& step) {
    forgetHolders(static_cast<size_t>(step.to.x.rows()));
    m_free = step.from.v;
    m_internal_known = false;
    bool pulled = false;
    for (const int pin : step.garment.pins()) {
        m_held[static_cast<size_t>(pin)] = 1;
        pulled = pulled || step.to.x.row(pin) != step.from.x.row(pin);
    }
    if (pulled) m_internal_known = step.stepper.internal_forces(step.to.x, m_internal);
    if (m_internal_known) m_internal *= m_mass_ratio;
    balanceEnergy(step);
}

void TwoWayCoupling::forgetHolders(size_t nodes) {
    m_holder.assign(nodes, nullptr);
    m_held.assign(nodes, 0);
    m_touches.solid.assign(nodes, -1);
}

/// What each node touches at the end of the cloth step, and the dynamic body that holds it.
void TwoWayCoupling::findHolders(const ClothStep& step) {
    const size_t count = static_cast<size_t>(step.to.x.rows());
    forgetHolders(count);
    m_touches.place.resize(step.to.x.rows(), 3);
    m_distance.assign(count, std::numeric_limits<double>::infinity());
    const Points& x = step.to.x;
    const auto touch = [&](size_t s, const Vec3& point, std::initializer_list<int> nodes) {
        for (int i : nodes)
            if (step.pinched.ignores(i, s)) return;
        const std::optional<double> distance = step.near[s].distance(point, kTouch);
        if (!distance) return;
        for (int i : nodes)
            if (*distance < m_distance[static_cast<size_t>(i)]) {
                m_distance[static_cast<size_t>(i)] = *distance;
                m_holder[static_cast<size_t>(i)] = step.near[s].body;
                m_held[static_cast<size_t>(i)] = 1;
                m_touches.solid[static_cast<size_t>(i)] = static_cast<int>(s);
                m_touches.place.row(i) = point;
            }
    };
    for (size_t s = 0; s < step.near.size(); ++s) {
        for (int i = 0; i < static_cast<int>(count); ++i) touch(s, x.row(i), {i});
        for (const auto& [a, b] : step.garment.edges())
            touch(s, 0.5 * (x.row(a) + x.row(b)), {a, b});
        const Faces& faces = step.garment.rest().faces;
        for (Eigen::Index f = 0; f < faces.rows(); ++f)
            touch(s, (x.row(faces(f, 0)) + x.row(faces(f, 1)) + x.row(faces(f, 2))) / 3.0,
                  {faces(f, 0), faces(f, 1), faces(f, 2)});
    }
    releasePinching(step);
    for (int pin : step.garment.pins()) {
        m_holder[static_cast<size_t>(pin)] = nullptr;
        m_held[static_cast<size_t>(pin)] = 1;
        m_touches.solid[static_cast<size_t>(pin)] = -1;
    }
    for (const int node : nodesHeldByGoals(step)) {
        m_holder[static_cast<size_t>(node)] = nullptr;
        m_held[static_cast<size_t>(node)] = 1;
        m_touches.solid[static_cast<size_t>(node)] = -1;
    }
    holdByAnchors();
}

void TwoWayCoupling::holdByAnchors() {
    for (int a = 0; a < m_body.m_anchors.size(); ++a) {
        const btSoftBody::Anchor& anchor = m_body.m_anchors[a];
        if (isHardAnchor(anchor) && anchor.m_node->m_im > 0 && isDynamic(*anchor.m_body))
            m_holder[static_cast<size_t>(anchor.m_node - &m_body.m_nodes[0])] = anchor.m_body;
    }
}

/// Anchored nodes move as their body does: their path is that of a chord, or a jump.
void TwoWayCoupling::moveAnchored(const ClothStep& step) {
    for (const int pin : step.garment.pins()) {
        const btRigidBody* body = m_holder[static_cast<size_t>(pin)];
        if (!body) continue;
        const Vector6 moved = changeByMoving(step, *body);
        const Vec3 arm = Vec3(step.to.x.row(pin)) - centreOf(*body);
        const Vec3 velocity =
            velocityOf(*body, step.to.x.row(pin)) + moved.head<3>() + moved.tail<3>().cross(arm);
        if (fitsFloats(velocity)) step.to.v.row(pin) = velocity;
    }
}

/// By gravity, node forces and the fabric's own.
void TwoWayCoupling::findFreeVelocities(const ClothStep& step) {
    m_free = step.from.v;
    m_free.rowwise() += step.length * step.boundary.gravity.transpose();
    if (step.boundary.accelerations.size()) m_free += step.length * step.boundary.accelerations;
    for (int i = 0; m_internal_known && i < m_body.m_nodes.size(); ++i) {
        const double mass = m_masses[i];
        if (mass > 0.0) m_free.row(i) += step.length / mass * m_internal.row(i);
    }
}

/// Nothing holds the cloth at the end: what pushed it in passing, and no longer touches it, would
/// not be pushed back.
void TwoWayCoupling::keepMomentum(const ClothStep& step) {
    Vec3 gained = Vec3::Zero();
    for (Eigen::Index i = 0; i < m_masses.size(); ++i)
        gained += m_masses[i] * changeByOthers(step, i);
    returnToCloth(step, -gained);
}

/// The impulse on the body, without what a contact of this normal cannot give.
Vec3 TwoWayCoupling::withinFriction(const btRigidBody& body, const Vec3& normal,
                                    const Vec3& impulse) const {
    const double push = std::max(0.0, -impulse.dot(normal));
    const Vec3 rub = impulse - impulse.dot(normal) * normal;
    const double most =
        std::min(usableFriction(m_body.m_cfg.kDF) * usableFriction(body.getFriction()),
                 kMostFriction) *
        push;
    return -push * normal + (rub.norm() > most ? most / rub.norm() : 1.0) * rub;
}

void TwoWayCoupling::chargeSide(const ClothStep& step, int node, const Vec3& impulse,
                                Account& account) const {
    const btRigidBody* holder = m_holder[static_cast<size_t>(node)];
    Vec3 normal = Vec3::Zero();
    for (const NearSolid& solid : step.near)
        if (solid.body == holder) normal = solid.outward(m_touches.place.row(node), kPinch);
    const Vec3 local = toMatrix(holder->getWorldTransform().getBasis()).transpose() * normal;
    Eigen::Index axis;
    local.cwiseAbs().maxCoeff(&axis);
    Side& side = account.sides[static_cast<size_t>(2 * axis + (local[axis] < 0.0))];
    side.impulse += impulse;
    side.normal += normal;
    side.arm += Vec3(m_touches.place.row(node)) - centreOf(*holder);
    ++side.count;
}

/// Where nothing else holds the cloth, what the cones leave is the body's, too.
void TwoWayCoupling::closeSides(const btRigidBody& body, Account& account) const {
    for (const Side& side : account.sides) {
        if (side.count == 0) continue;
        const Vec3 given = withinFriction(body, side.normal.stableNormalized(), side.impulse);
        account.taken.head<3>() += m_floats ? side.impulse : given;
        account.taken.tail<3>() += (side.arm / side.count).cross(given);
    }
}

/// Whether the node lies between its holder and a solid that bears it.
bool TwoWayCoupling::isPinched(const ClothStep& step, int node, const NearSolid& holder) const {
    const Vec3 place = m_touches.place.row(node);
    for (const NearSolid& solid : step.near)
        if (!solid.body && solid.distance(place, kPinch) &&
            solid.outward(place, kPinch).dot(holder.outward(place, kPinch)) < -0.1)
            return true;
    return false;
}

void TwoWayCoupling::releasePinching(const ClothStep& step) {
    const int count = static_cast<int>(m_holder.size());
    for (const NearSolid& holder : step.near) {
        if (!holder.body) continue;
        const auto held = [&](int i) { return m_holder[static_cast<size_t>(i)] == holder.body; };
        bool pinches = false;
        for (int i = 0; i < count && !pinches; ++i) pinches = held(i) && isPinched(step, i, holder);
        if (pinches)
            std::replace(m_holder.begin(), m_holder.end(), holder.body,
                         static_cast<btRigidBody*>(nullptr));
    }
}

/// The held node that each node is nearest to, in edges.
void TwoWayCoupling::findOwners(const ClothStep& step) {
    m_owner.assign(m_held.size(), -1);
    m_queue.clear();
    for (size_t i = 0; i < m_held.size(); ++i)
        if (m_held[i]) {
            m_owner[i] = static_cast<int>(i);
            m_queue.push_back(static_cast<int>(i));
        }
    // What holds the cloth without being known would be taken for one of these.
    if (!allSolidsKnown(step)) return;
    if (m_neighbours.size() != m_held.size()) {
        m_neighbours.assign(m_held.size(), {});
        for (const auto& [a, b] : step.garment.edges()) {
            m_neighbours[static_cast<size_t>(a)].push_back(b);
            m_neighbours[static_cast<size_t>(b)].push_back(a);
        }
    }
    for (size_t next = 0; next < m_queue.size(); ++next) {
        const auto i = static_cast<size_t>(m_queue[next]);
        for (int j : m_neighbours[i])
            if (m_owner[static_cast<size_t>(j)] < 0) {
                m_owner[static_cast<size_t>(j)] = m_owner[i];
                m_queue.push_back(j);
            }
    }
}

/// Momentum balance of every node, summed over the nodes that a held one owns; what its holder gave
/// is added to the holder's impulse.
void TwoWayCoupling::findImpulses(const ClothStep& step) {
    const double h = step.length;
    m_impulses.setZero(step.to.x.rows(), 3);
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        const int owner = m_owner[static_cast<size_t>(i)];
        const double mass = m_masses[i];
        if (owner < 0 || mass == 0.0) continue;
        m_impulses.row(owner) += mass * changeByOthers(step, i);
        if (m_internal_known) m_impulses.row(owner) -= h * m_internal.row(i);
    }
    for (int i = 0; i < m_body.m_nodes.size(); ++i)
        if (m_holder[static_cast<size_t>(i)]) charge(step, i);
}

/// Adds what a held node took to its holder's impulse.
void TwoWayCoupling::charge(const ClothStep& step, int node) {
    const btRigidBody& holder = *m_holder[static_cast<size_t>(node)];
    Account& account = m_accounts[m_holder[static_cast<size_t>(node)]];
    const bool anchored = step.garment.is_pinned()[static_cast<size_t>(node)] != 0;
    const Vec3 arm = Vec3(step.to.x.row(node)) - centreOf(holder);
    const Vec3 impulse = -m_impulses.row(node).transpose();
    if (anchored && !m_internal_known) return;
    if (anchored) {
        account.taken.head<3>() += impulse;
        account.taken.tail<3>() += arm.cross(impulse);
    } else {
        chargeSide(step, node, impulse, account);
    }
    account.nodes.push_back(node);
    account.anchored |= anchored;
    const Vec3 met =
        toVec3(holder.getVelocityInLocalPoint(toBullet(arm))) - Vec3(step.from.v.row(node));
    account.meeting = std::max(account.meeting, met.norm());
}

std::vector<TwoWayCoupling::Follower> TwoWayCoupling::followersOf(const ClothStep& step,
                                                                  const btRigidBody& body,
                                                                  const Account& account) const {
    std::vector<Follower> followers;
    std::vector<int> anchors;
    const Vec3 centre = centreOf(body);
    for (int i : account.nodes) {
        followers.push_back({i, Vec3(step.to.x.row(i)) - centre, 1.0});
        if (step.garment.is_pinned()[static_cast<size_t>(i)]) anchors.push_back(i);
    }
    if (anchors.empty()) return followers;
    const Fabric& fabric = step.garment.fabric();
    const double reach = step.length * std::sqrt(fabric.longitudinal() / fabric.density);
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        if (step.garment.is_pinned()[static_cast<size_t>(i)]) continue;
        int nearest = -1;
        double distance = reach;
        for (int anchor : anchors) {
            const double d = (step.to.x.row(i) - step.to.x.row(anchor)).norm();
            if (d < distance) {
                distance = d;
                nearest = anchor;
            }
        }
        if (nearest >= 0)
            followers.push_back({i, Vec3(step.to.x.row(nearest)) - centre, 1.0 - distance / reach});
    }
    return followers;
}

/// The common motion of the class comment.
void TwoWayCoupling::settle(const ClothStep& step, btRigidBody& body, Account& account) {
    const Matrix6 mass = massMatrix(body);
    Matrix6 both = mass;
    const std::vector<Follower> followers = followersOf(step, body, account);
    for (const Follower& follower : followers) {
        Eigen::Matrix<double, 3, 6> motion;
        motion << Eigen::Matrix3d::Identity(), -crossMatrix(follower.arm);
        both += follower.weight * m_masses[follower.node] * (motion.transpose() * motion);
    }
    // What has moved with the cloth has most of its change already.
    const Vector6 moved = changeByMoving(step, body);
    if (step.anchored) account.lift = step.anchored->liftOf(body);
    // A cloth step that was cut short has left something to hand over.
    Vector6 change = solve(both, account.taken + account.planned - mass * moved);
    if (!change.allFinite()) return;
    const Vec3 velocity = toVec3(body.getLinearVelocity()) + moved.head<3>();
    const Vec3 turning = toVec3(body.getAngularVelocity()) + moved.tail<3>();
    if (account.anchored) {
        // No body gets faster at once than it or the cloth is.
        const double fastest =
            std::max(velocity.norm(), std::sqrt(step.from.v.rowwise().squaredNorm().maxCoeff()));
        const double most = fastest + kTaut * step.length;
        const double speed = (velocity + change.head<3>()).norm();
        if (speed > most)
            change.head<3>() = (most / speed) * (velocity + change.head<3>()) - velocity;
    } else {
        // A collision does not give back more than it was, a taut cloth not more than 100 m/s^2.
        const double most = 2.0 * account.meeting + kTaut * step.length;
        if (change.head<3>().norm() > most) change *= most / change.head<3>().norm();
    }
    change.tail<3>() = limitedTurn(turning, change.tail<3>(), step.length);
    if (account.anchored && m_floats)
        returnToCloth(step,
                      (account.taken + account.planned - mass * moved - both * change).head<3>());
    for (const Follower& follower : followers) {
        const Vec3 follows = change.head<3>() + change.tail<3>().cross(follower.arm);
        step.to.v.row(follower.node) += follower.weight * follows.transpose();
    }
    account.planned = mass * (moved + change);
    account.plan_time = step.length;
}

/// Nothing but bodies holds the cloth: what these did not take of an impulse (N s), it keeps.
void TwoWayCoupling::returnToCloth(const ClothStep& step, const Vec3& impulse) {
    VectorX masses = m_masses;
    for (const int pin : step.garment.pins()) masses[pin] = 0.0;
    const double mass = masses.sum();
    if (!(mass > 0.0)) return;
    for (Eigen::Index i = 0; i < masses.size(); ++i)
        if (masses[i] > 0.0) step.to.v.row(i) += impulse.transpose() / mass;
}

/// What node forces, moving solids that cannot be pushed, and pins that are no anchors of dynamic
/// bodies put into the cloth (J). What they take out does not count.
double TwoWayCoupling::workFromOutside(const ClothStep& step) const {
    double work = 0.0;
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        const auto n = static_cast<size_t>(i);
        const double mass = m_masses[i];
        const Vec3 path = step.to.x.row(i) - step.from.x.row(i);
        if (step.boundary.accelerations.size())
            work += mass * std::max(0.0, step.boundary.accelerations.row(i).dot(path));
        if (m_holder[n] || !m_held[n]) continue;
        const int s = m_touches.solid[n];
        if (s >= 0 && step.near[static_cast<size_t>(s)].body) continue;  // it pinches
        Vec3 impulse = mass * (step.to.v.row(i) - m_free.row(i));
        Vec3 velocity = path / step.length;
        if (s >= 0)
            velocity =
                step.near[static_cast<size_t>(s)].velocity(m_touches.place.row(i), step.length);
        else if (mass == 0.0 && m_internal_known)
            impulse = -step.length * m_internal.row(i);
        work += std::max(0.0, impulse.dot(velocity));
    }
    return work;
}

/// Whether a body may have pushed the cloth in this step. Where it did, no node need touch it now.
bool TwoWayCoupling::presses(const ClothStep& step, const NearSolid& solid) const {
    if (!solid.body) return false;
    const auto found = m_accounts.find(solid.body);
    if (found != m_accounts.end() && found->second.anchored) return false;
    if (found != m_accounts.end() && !found->second.nodes.empty()) return true;
    const double reach = step.garment.mean_edge_length();
    for (Eigen::Index i = 0; i < step.to.x.rows(); ++i)
        if (solid.distance(step.to.x.row(i), reach)) return true;
    return false;
}

/// Whether bodies that press into the cloth are where its step ends: one that looks ahead, past
/// the end of the world step, only foresees them there.
bool TwoWayCoupling::bodiesWait(const ClothStep& step) const {
    constexpr double kSame = 1e-4;  // m
    return std::all_of(step.near.begin(), step.near.end(), [&](const NearSolid& solid) {
        const bool is_there =
            !solid.body ||
            (solid.inverse.inverse().translation() - centreOf(*solid.body)).norm() < kSame;
        return is_there || !presses(step, solid);
    });
}

/// Puts bodies that press into the cloth on a part of the way that Bullet moved them, as the cloth
/// is, and leaves them that part of their motion. What it lifts them by, the next step pays.
void TwoWayCoupling::holdBodies(const ClothStep& step, double way) {
    for (const NearSolid& solid : step.near) {
        if (!presses(step, solid)) continue;
        btRigidBody& body = *solid.body;
        const Pose before = solid.inverse_before.inverse(), now = solid.inverse.inverse();
        const Pose held = interpolate(before, now, way);
        const Vec3 back = held.translation() - now.translation();
        m_energy.owe(-toVec3(body.getGravity()).dot(back) / body.getInvMass());
        Account& account = m_accounts[&body];
        account.plan_time = step.length;
        account.planned -= (1.0 - way) * (massMatrix(body) * motionOf(body) + account.planned);
        body.setCenterOfMassTransform(toBullet(held));
        m_held_bodies.push_back(&body);
    }
}

/// Hands the planned impulses to the balance of energy. Anchored nodes move with their bodies, also
/// where it took some of them.
void TwoWayCoupling::balanceEnergy(const ClothStep& step) {
    std::vector<EnergyBalance::Share> shares;
    Vec3 momentum = Vec3::Zero();  // that the balance adds (N s)
    for (auto& [body, account] : m_accounts) {
        shares.push_back({body, &account.planned, account.anchored, account.lift});
        momentum -= account.planned.head<3>();
    }
    const EnergyBalance::Result result = m_energy.settle(
        step, {m_masses, m_mass_ratio, workFromOutside(step), m_floats, bodiesWait(step)}, shares);
    m_calmed = result.much && !m_accounts.empty();
    m_unbalanced = result.unknown && !m_accounts.empty();
    m_held_back = result.held;
    if (result.together && result.way < 1.0) holdBodies(step, result.way);
    for (auto& [body, account] : m_accounts) account.gain = gainOf(*body, account.planned);
    if (!result.limited) return;
    for (const auto& [body, account] : m_accounts) momentum += account.planned.head<3>();
    for (const int pin : step.garment.pins()) {
        const auto found = m_accounts.find(m_holder[static_cast<size_t>(pin)]);
        if (found == m_accounts.end()) continue;
        const btRigidBody& body = *found->first;
        const Vector6 after = motionOf(body) + solve(massMatrix(body), found->second.planned);
        const Vec3 arm = Vec3(step.to.x.row(pin)) - centreOf(body);
        const Vec3 velocity = after.head<3>() + after.tail<3>().cross(arm);
        if (!fitsFloats(velocity)) continue;
        momentum += m_masses[pin] * (velocity - Vec3(step.to.v.row(pin)));
        step.to.v.row(pin) = velocity;
    }
    if (m_floats) returnToCloth(step, -momentum);
}

/// The pointer of a body that is gone must not be followed.
void TwoWayCoupling::forgetAbsent(const std::vector<NearSolid>& near) {
    const auto is_there = [&](const btRigidBody* body) {
        for (const NearSolid& solid : near)
            if (solid.body == body) return true;
        for (int a = 0; a < m_body.m_anchors.size(); ++a)
            if (m_body.m_anchors[a].m_body == body) return true;
        return false;
    };
    for (auto it = m_accounts.begin(); it != m_accounts.end();)
        it = is_there(it->first) ? std::next(it) : m_accounts.erase(it);
}

void TwoWayCoupling::apply(double h, const std::vector<NearSolid>& near) {
    m_last_impulse.setZero();
    forgetAbsent(near);
    for (auto& [body, account] : m_accounts) {
        const double part = h < account.plan_time ? h / account.plan_time : 1.0;
        Vector6 now = part * account.planned;
        account.planned -= now;
        if (!isDynamic(*body) || !fitsFloats(now)) continue;
        // Where something else has stopped the body since, the rest would make energy.
        const double falling = account.plan_time * toVec3(m_body.m_worldInfo->m_gravity).norm();
        now *= partThatGains(*body, now, account.gain + falling * now.head<3>().norm());
        account.gain -= gainOf(*body, now);
        account.plan_time = std::max(0.0, account.plan_time - h);
        body->applyCentralImpulse(toBullet(Vec3(now.head<3>())));
        body->applyTorqueImpulse(toBullet(Vec3(now.tail<3>())));
        m_last_impulse += now.head<3>();
    }
}

}  // namespace cloth
