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

bool isDynamic(const btRigidBody& body) {
    return body.getInvMass() > 0 && !body.isStaticOrKinematicObject();
}

Vec3 centreOf(const btRigidBody& body) {
    return toVec3(body.getCenterOfMassPosition());
}

/// Bodies that cannot turn count as ones that hardly can.
Eigen::Matrix<double, 6, 6> massMatrix(const btRigidBody& body) {
    constexpr double kLeast = 1e-9;
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    const double inverse = std::max(static_cast<double>(body.getInvMass()), kLeast);
    matrix.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / inverse;
    const Vec3 moments = toVec3(body.getInvInertiaDiagLocal()).cwiseMax(kLeast).cwiseInverse();
    const Eigen::Matrix3d turn = toMatrix(body.getCenterOfMassTransform().getBasis());
    matrix.bottomRightCorner<3, 3>() = turn * moments.asDiagonal() * turn.transpose();
    return matrix;
}

/// Cloth spins no body faster than this per cloth step, whatever the lever: pins are extrapolated
/// over a cloth step, and farther than that the extrapolation amplifies the spin.
Vec3 limitedTurn(const Vec3& turning, const Vec3& change, double length) {
    constexpr double kTurn = 0.3;  // rad
    const double limit = std::max(turning.norm(), kTurn / length);
    const double speed = (turning + change).norm();
    return speed > limit ? Vec3((limit / speed) * (turning + change) - turning) : change;
}

/// Whether all that holds the cloth can be moved by it.
bool floatsFreely(const btSoftBody& body, const ClothStep& step) {
    for (int pin : step.garment.pins())
        if (!(body.m_nodes[pin].m_im > 0)) return false;
    for (int a = 0; a < body.m_anchors.size(); ++a)
        if (!isDynamic(*body.m_anchors[a].m_body)) return false;
    return std::all_of(step.near.begin(), step.near.end(),
                       [](const NearSolid& solid) { return solid.body != nullptr; });
}

/// Whether the solids near the cloth are all that its stepper saw.
bool allSolidsKnown(const ClothStep& step) {
    size_t parts = 0;
    for (const NearSolid& solid : step.near) parts += solid.parts->size();
    return parts == step.boundary.obstacles.size();
}

}  // namespace

void TwoWayCoupling::collect(const ClothStep& step) {
    forgetAbsent(step.near);
    m_mass_ratio = massRatio(m_body, step.garment);
    for (auto& entry : m_accounts) {
        entry.second.taken.setZero();
        entry.second.nodes.clear();
        entry.second.meeting = 0.0;
        entry.second.anchored = false;
        entry.second.sides = {};
    }
    findHolders(step);
    const bool held = std::any_of(m_holder.begin(), m_holder.end(),
                                  [](const btRigidBody* body) { return body != nullptr; });
    if (held) {
        findOwners(step);
        findImpulses(step);
    }
    const bool floats = floatsFreely(m_body, step) && allSolidsKnown(step);
    for (auto it = m_accounts.begin(); it != m_accounts.end();) {
        closeSides(*it->first, floats, it->second);
        settle(step, *it->first, it->second);
        const bool done = it->second.nodes.empty() && it->second.planned.norm() < 1e-12;
        it = done ? m_accounts.erase(it) : std::next(it);
    }
}

/// kg; 0 for nodes that nothing can move
double TwoWayCoupling::massOf(const ClothStep& step, int node) const {
    return m_body.m_nodes[node].m_im > 0 ? m_mass_ratio * step.garment.masses()[node] : 0.0;
}

/// The dynamic body that each node is anchored to or touches at the end of the cloth step.
void TwoWayCoupling::findHolders(const ClothStep& step) {
    const size_t count = static_cast<size_t>(step.to.x.rows());
    m_holder.assign(count, nullptr);
    m_held.assign(count, 0);
    m_touch.resize(step.to.x.rows(), 3);
    m_distance.assign(count, std::numeric_limits<double>::infinity());
    const Points& x = step.to.x;
    const auto touch = [&](const NearSolid& obstacle, const Vec3& point,
                           std::initializer_list<int> nodes) {
        const std::optional<double> distance = obstacle.distance(point, kTouch);
        if (!distance) return;
        for (int i : nodes)
            if (*distance < m_distance[static_cast<size_t>(i)]) {
                m_distance[static_cast<size_t>(i)] = *distance;
                m_holder[static_cast<size_t>(i)] = obstacle.body;
                m_held[static_cast<size_t>(i)] = 1;
                m_touch.row(i) = point;
            }
    };
    for (const NearSolid& obstacle : step.near) {
        for (int i = 0; i < static_cast<int>(count); ++i) touch(obstacle, x.row(i), {i});
        for (const auto& [a, b] : step.garment.edges())
            touch(obstacle, 0.5 * (x.row(a) + x.row(b)), {a, b});
        const Faces& faces = step.garment.rest().faces;
        for (Eigen::Index f = 0; f < faces.rows(); ++f)
            touch(obstacle, (x.row(faces(f, 0)) + x.row(faces(f, 1)) + x.row(faces(f, 2))) / 3.0,
                  {faces(f, 0), faces(f, 1), faces(f, 2)});
    }
    releasePinching(step);
    for (int pin : step.garment.pins()) {
        m_holder[static_cast<size_t>(pin)] = nullptr;
        m_held[static_cast<size_t>(pin)] = 1;
    }
    for (int a = 0; a < m_body.m_anchors.size(); ++a) {
        const btSoftBody::Anchor& anchor = m_body.m_anchors[a];
        if (isHardAnchor(anchor) && anchor.m_node->m_im > 0 && isDynamic(*anchor.m_body))
            m_holder[static_cast<size_t>(anchor.m_node - &m_body.m_nodes[0])] = anchor.m_body;
    }
}

/// The impulse on the body, without what a contact of this normal cannot give.
Vec3 TwoWayCoupling::withinFriction(const btRigidBody& body, const Vec3& normal,
                                    const Vec3& impulse) const {
    const double push = std::max(0.0, -impulse.dot(normal));
    const Vec3 rub = impulse - impulse.dot(normal) * normal;
    const double most = static_cast<double>(m_body.m_cfg.kDF * body.getFriction()) * push;
    return -push * normal + (rub.norm() > most ? most / rub.norm() : 1.0) * rub;
}

void TwoWayCoupling::chargeSide(const ClothStep& step, int node, const Vec3& impulse,
                                Account& account) const {
    const btRigidBody* holder = m_holder[static_cast<size_t>(node)];
    Vec3 normal = Vec3::Zero();
    for (const NearSolid& solid : step.near)
        if (solid.body == holder) normal = solid.outward(m_touch.row(node), kPinch);
    const Vec3 local = toMatrix(holder->getWorldTransform().getBasis()).transpose() * normal;
    Eigen::Index axis;
    local.cwiseAbs().maxCoeff(&axis);
    Side& side = account.sides[static_cast<size_t>(2 * axis + (local[axis] < 0.0))];
    side.impulse += impulse;
    side.normal += normal;
    side.arm += Vec3(m_touch.row(node)) - centreOf(*holder);
    ++side.count;
}

/// @param all  nothing else holds the cloth: what the cones leave is the body's, too
void TwoWayCoupling::closeSides(const btRigidBody& body, bool all, Account& account) const {
    for (const Side& side : account.sides) {
        if (side.count == 0) continue;
        const Vec3 given = withinFriction(body, side.normal.stableNormalized(), side.impulse);
        account.taken.head<3>() += all ? side.impulse : given;
        account.taken.tail<3>() += (side.arm / side.count).cross(given);
    }
}

/// Whether the node lies between its holder and another solid.
bool TwoWayCoupling::isPinched(const ClothStep& step, int node, const NearSolid& holder) const {
    const Vec3 place = m_touch.row(node);
    for (const NearSolid& solid : step.near)
        if (solid.body != holder.body && solid.distance(place, kPinch) &&
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
    m_internal_known = step.stepper.internal_forces(step.to.x, m_internal);
    if (m_internal_known) m_internal *= m_mass_ratio;
    for (int i = 0; i < m_body.m_nodes.size(); ++i) {
        const int owner = m_owner[static_cast<size_t>(i)];
        const double mass = massOf(step, i);
        if (owner < 0 || mass == 0.0) continue;
        Vec3 velocity = step.to.v.row(i) - step.from.v.row(i);
        velocity -= h * step.boundary.gravity;
        if (step.boundary.accelerations.size())
            velocity -= h * step.boundary.accelerations.row(i).transpose();
        m_impulses.row(owner) += mass * velocity;
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
void TwoWayCoupling::settle(const ClothStep& step, const btRigidBody& body, Account& account) {
    const Matrix6 mass = massMatrix(body);
    Matrix6 both = mass;
    const std::vector<Follower> followers = followersOf(step, body, account);
    for (const Follower& follower : followers) {
        Eigen::Matrix<double, 3, 6> motion;
        motion << Eigen::Matrix3d::Identity(), -crossMatrix(follower.arm);
        both += follower.weight * massOf(step, follower.node) * (motion.transpose() * motion);
    }
    // A cloth step that was cut short has left something to hand over.
    Vector6 change = both.ldlt().solve(account.taken + account.planned);
    if (!change.allFinite()) return;
    const Vec3 turning = toVec3(body.getAngularVelocity());
    if (!account.anchored) {
        // A collision does not give back more than it was, a taut cloth not more than 100 m/s^2.
        const double most = 2.0 * account.meeting + 100.0 * step.length;
        if (change.head<3>().norm() > most) change *= most / change.head<3>().norm();
    }
    change.tail<3>() = limitedTurn(turning, change.tail<3>(), step.length);
    for (const Follower& follower : followers) {
        const Vec3 velocity = change.head<3>() + change.tail<3>().cross(follower.arm);
        step.to.v.row(follower.node) += follower.weight * velocity.transpose();
    }
    account.planned = mass * change;
    account.plan_time = step.length;
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
        const Vector6 now = part * account.planned;
        account.planned -= now;
        account.plan_time = std::max(0.0, account.plan_time - h);
        if (!isDynamic(*body) || !fitsFloats(now)) continue;
        body->applyCentralImpulse(toBullet(Vec3(now.head<3>())));
        body->applyTorqueImpulse(toBullet(Vec3(now.tail<3>())));
        m_last_impulse += now.head<3>();
    }
}

}  // namespace cloth
