#include "bullet_ext/btGnnSoftBodySolver.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "bullet_ext/bodyFollower.h"
#include "bullet_ext/bodyGoals.h"
#include "bullet_ext/clothContacts.h"
#include "bullet_ext/materialFabric.h"
#include "bullet_ext/rootMotion.h"
#include "bullet_ext/softBodyGarment.h"
#include "bullet_ext/softBodyStep.h"
#include "bullet_ext/solveSteps.h"
#include "collision/response/skin_blend.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/deadline.h"

using cloth::ArgumentError;
using cloth::Garment;
using cloth::isFinite;
using cloth::worldIdOf;

namespace {

/// Gravity that is no number is none in a world step; then it is the user's again.
class FiniteGravity {
 public:
    explicit FiniteGravity(const btAlignedObjectArray<btSoftBody*>& bodies) {
        for (int i = 0; i < bodies.size(); ++i)
            if (!isFinite(bodies[i]->m_worldInfo->m_gravity)) m_bodies.push_back(bodies[i]);
        for (const btSoftBody* body : m_bodies) {
            m_before.push_back(body->m_worldInfo->m_gravity);
            body->m_worldInfo->m_gravity.setZero();
        }
    }
    ~FiniteGravity() {
        // Bodies share it: the first of them found it as it was.
        for (size_t i = m_bodies.size(); i-- > 0;)
            m_bodies[i]->m_worldInfo->m_gravity = m_before[i];
    }
    FiniteGravity(const FiniteGravity&) = delete;
    FiniteGravity& operator=(const FiniteGravity&) = delete;
    const std::vector<const btSoftBody*>& bodies() const { return m_bodies; }

 private:
    std::vector<const btSoftBody*> m_bodies;
    std::vector<btVector3> m_before;
};

/// setTotalMass(0) makes infinite ones.
bool hasFiniteMasses(const btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (!std::isfinite(body.m_nodes[i].m_im)) return false;
    return true;
}

bool hasFiniteNodes(const btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (!isFinite(body.m_nodes[i].m_x) || !isFinite(body.m_nodes[i].m_v)) return false;
    return hasFiniteMasses(body);
}

/// Bullet's distance field numbers its cells with ints, unchecked.
bool fitsDistanceField(const btSoftBody& body) {
    constexpr double kFarthest = 1e7;  // m
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (!(cloth::toVec3(body.m_nodes[i].m_x).cwiseAbs().maxCoeff() < kFarthest)) return false;
    return true;
}

/// Bounds that are not finite damage Bullet's broadphase for all objects, its tree loses what is
/// beside them; and Bullet disables the body for good.
void mendBounds(btSoftBody& body) {
    btBroadphaseProxy* proxy = body.getBroadphaseHandle();
    const bool spoilt = proxy && !(isFinite(proxy->m_aabbMin) && isFinite(proxy->m_aabbMax));
    if (!spoilt && isFinite(body.m_bounds[0]) && isFinite(body.m_bounds[1])) return;
    const btVector3 zero(0, 0, 0);
    body.m_bounds[0] = body.m_bounds[1] = zero;
    if (proxy && body.m_worldInfo->m_broadphase)
        body.m_worldInfo->m_broadphase->setAabb(proxy, zero, zero, body.m_worldInfo->m_dispatcher);
}

Garment scaledGarment(const Garment& garment, double factor) {
    cloth::TriMesh rest = garment.rest();
    rest.vertices *= factor;
    const bool curved = (garment.hinge_rest_angles().array() != 0.0).any();
    return Garment(garment.name(), std::move(rest), garment.fabric(), garment.pins(), curved);
}

/// The same garment with the limits of its body.
Garment limitedGarment(const Garment& garment, const std::optional<cloth::GoalLimits>& limits) {
    return garment.with_goals(limits.value_or(cloth::GoalLimits()));
}

bool areLimitsOf(const btSoftBody& body, const cloth::GoalLimits& limits) {
    const auto fits = [&](const cloth::VectorX& values) {
        return values.size() == 0 || values.size() == body.m_nodes.size();
    };
    return fits(limits.max_distance) && fits(limits.backstop) && fits(limits.drive_stiffness) &&
           fits(limits.drive_damping);
}

void checkGoals(const btSoftBody& body, const cloth::SkinGoals& goals, double duration) {
    const Eigen::Index nodes = body.m_nodes.size();
    const std::string name = cloth::softBodyName(body) + ": goals";
    const auto fits = [&](const cloth::Points& points, bool optional) {
        return points.rows() == nodes || (optional && points.rows() == 0);
    };
    if (!fits(goals.x0, false) || !fits(goals.x1, false) || !fits(goals.normal0, true) ||
        !fits(goals.normal1, true))
        throw ArgumentError(name, "are not of " + std::to_string(nodes) + " nodes",
                            "give one place for each node, now and later, and as many normals or "
                            "none");
    if (!goals.x0.allFinite() || !goals.x1.allFinite() || !goals.normal0.allFinite() ||
        !goals.normal1.allFinite() || !(duration >= 0.0) || std::isinf(duration))
        throw ArgumentError(name, "have places, normals or a duration that are not finite",
                            "check the animation before handing it over");
}

/// How many nodes and faces it has, in one number: all that tells bodies in no world apart.
long meshSizeOf(const btSoftBody& body) {
    return (static_cast<long>(body.m_nodes.size()) << 32) + body.m_faces.size();
}

constexpr btScalar kMostGravity = 100;  // m/s^2: four times Jupiter's

/// What cloth and bodies did to each other, or the scene to the cloth, that a user should know of.
std::vector<std::string> troublesOf(const btSoftBody& body, const cloth::Stepper& stepper,
                                    const cloth::SoftBodyStep::Result& result) {
    std::vector<std::string> troubles;
    const std::string name = cloth::softBodyName(body);
    if (result.calmed)
        troubles.push_back(
            name +
            ": cloth and rigid bodies would have made energy in a step, which was taken away. "
            "Remedy: if it looks stiff, smaller time steps, or masses that differ less");
    if (result.unbalanced)
        troubles.push_back(
            name + ": its stepper " + stepper.name() +
            " does not know its energy, so what it and dynamic bodies give each "
            "other is not balanced, and may grow. Remedy: make_cloth() where dynamic "
            "bodies land on cloth; nothing, if it looks right");
    if (result.without_goals)
        troubles.push_back(name +
                           ": it has goal limits and was never given goals, so it is held where it "
                           "was. Remedy: call setGoals() before each stepSimulation()");
    if (result.caught_nodes > 0)
        troubles.push_back(
            name +
            ": bodies that close on it leave it no room, so it passes through the lighter one. "
            "Remedy: smaller time steps, or bodies that sink less into each other");
    if (result.stretched_anchor >= 0)
        troubles.push_back(
            name + ": node " + std::to_string(result.stretched_anchor) +
            ": its anchor is farther away than the cloth reaches, an edge there is over twice as "
            "long as at rest. Remedy: anchor the node where it is, or take a stiffer fabric");
    if (result.left_behind)
        troubles.push_back(
            name +
            ": it was paused by m_cfg.timescale, and the animated obstacle at it went away, so it "
            "goes on alone. Remedy: pause the character, too, or teleport() the cloth to it before "
            "it goes on");
    if (result.idle_anchor >= 0)
        troubles.push_back(name + ": node " + std::to_string(result.idle_anchor) +
                           ": appendDeformableAnchor() to a rigid body does nothing outside of "
                           "Bullet's deformable "
                           "world. Remedy: appendAnchor(), or a link of a btMultiBody");
    if (!(body.m_cfg.timescale >= 0))
        troubles.push_back(name +
                           ": m_cfg.timescale is negative or no number, and counts as 0: it is "
                           "paused. Remedy: 0 or more");
    if (!(body.m_cfg.kDF >= 0))
        troubles.push_back(name +
                           ": m_cfg.kDF is negative or no number, and counts as 0. Remedy: 0 to 1");
    const btScalar gravity = body.m_worldInfo->m_gravity.length();
    if (gravity > kMostGravity)
        troubles.push_back(name + ": gravity is " + std::to_string(std::lround(gravity)) +
                           " m/s^2, as where lengths are in centimetres; distances of contact are "
                           "in metres. Remedy: lengths and gravity in metres");
    return troubles;
}

/// Whether Bullet would let the two collide, and their boxes meet.
bool wouldCollide(const btSoftBody& a, const btSoftBody& b) {
    return cloth::askForContact(a, b) &&
           TestAabbAgainstAabb2(a.m_bounds[0], a.m_bounds[1], b.m_bounds[0], b.m_bounds[1]);
}

}  // namespace

btGnnSoftBodySolver::btGnnSoftBodySolver(cloth::StepperFactory factory,
                                         btGnnSolverSettings settings)
    : m_factory(std::move(factory)), m_settings(settings) {
    if (!m_factory)
        throw ArgumentError("btGnnSoftBodySolver", "the stepper factory is empty",
                            "give a function that makes a Stepper of a Garment");
    cloth::check_range("btGnnSolverSettings.obstacleReach", settings.obstacleReach, 0.02, 1.0);
    cloth::check_range("btGnnSolverSettings.sleepMotion", settings.sleepMotion, 0.0, 0.05);
    if (settings.layerThickness != 0.0) {
        cloth::check_range("btGnnSolverSettings.layerThickness", settings.layerThickness, 1e-3,
                           2e-2);
        m_contacts = std::make_unique<cloth::ClothContacts>(settings.layerThickness);
    }
    cloth::check_range("btGnnSolverSettings.maxFailedSteps", settings.maxFailedSteps, 1, 1000000);
    cloth::check_range("btGnnSolverSettings.maxMs", settings.maxMs, 0.1,
                       std::numeric_limits<double>::infinity());
}

btGnnSoftBodySolver::~btGnnSoftBodySolver() = default;

/// What is known of the body. Nothing is known of one that has left the world since, or of another
/// one at its address: of one that was in no world, the numbers of nodes and faces must do.
btGnnSoftBodySolver::Entry& btGnnSoftBodySolver::entryOf(const btSoftBody* body) {
    Entry& entry = m_entries[body];
    if (!body) return entry;
    const bool left = entry.worldId != 0 && entry.worldId != worldIdOf(*body);
    const bool is_another =
        entry.worldId == 0 && entry.mesh != 0 && entry.mesh != meshSizeOf(*body);
    if (left || is_another) entry = Entry();
    return entry;
}

/// The same, to be changed for the body as it is now.
btGnnSoftBodySolver::Entry& btGnnSoftBodySolver::entryToSet(const btSoftBody& body) {
    Entry& entry = entryOf(&body);
    entry.worldId = worldIdOf(body);
    entry.mesh = entry.worldId == 0 ? meshSizeOf(body) : 0;
    return entry;
}

void btGnnSoftBodySolver::attach(btSoftBody* body) {
    if (!body) throw ArgumentError("attach()", "the soft body is null", "create it first");
    Entry& entry = entryToSet(*body);
    entry.detached = false;
    entry.asked = true;
    build(*body, entry);
}

void btGnnSoftBodySolver::attach(btSoftBody* body, const Garment& garment,
                                 cloth::StepperFactory factory) {
    if (!body) throw ArgumentError("attach()", "the soft body is null", "create it first");
    cloth::checkGarmentFits(*body, garment);
    Entry& entry = entryToSet(*body);
    entry.given = std::make_shared<const Garment>(garment);
    if (garment.has_goals()) entry.limits = garment.goal_limits();
    entry.factory = std::move(factory);
    entry.detached = false;
    entry.asked = true;
    build(*body, entry);
}

void btGnnSoftBodySolver::attach(btSoftBody* body, const cloth::Fabric& fabric,
                                 cloth::StepperFactory factory) {
    if (!body) throw ArgumentError("attach()", "the soft body is null", "create it first");
    Entry& entry = entryToSet(*body);
    entry.given = nullptr;
    entry.fabric = fabric;
    entry.factory = std::move(factory);
    entry.detached = false;
    entry.asked = true;
    build(*body, entry);
}

void btGnnSoftBodySolver::detach(btSoftBody* body) {
    Entry& entry = entryOf(body);
    if (body) leaveToBullet(*body, entry);
    entry.detached = true;
    entry.worldId = 0;  // it holds where the body is put into a world anew
    entry.mesh = body && worldIdOf(*body) == 0 ? meshSizeOf(*body) : 0;
}

void btGnnSoftBodySolver::forget(const btSoftBody* body) {
    m_entries.erase(body);
}

void btGnnSoftBodySolver::leaveToBullet(btSoftBody& body, Entry& entry) {
    if (entry.step) entry.handover = cloth::BulletHandover(body);
    entry.step.reset();
    entry.stepping = Stepping::bullet;
}

/// Makes garment and stepper of the body as it is now.
void btGnnSoftBodySolver::build(btSoftBody& body, Entry& entry) {
    leaveToBullet(body, entry);
    entry.failures = 0;
    entry.topology = cloth::topologySignature(body);
    entry.restLengths = cloth::restLengths(body);
    if (!hasFiniteNodes(body)) entry.stepping = Stepping::frozen;
    cloth::checkCloth(body);
    if (entry.given) cloth::checkGarmentFits(body, *entry.given);
    auto garment =
        std::make_unique<const Garment>(limitedGarment(garmentFor(body, entry), entry.limits));
    if (!entry.asked && cloth::isClosed(body)) {
        entry.detached = true;  // for good: what is cut open later shall not collapse, either
        throw ArgumentError(cloth::softBodyName(body),
                            "its surface is closed, so Bullet steps it: its links and bending "
                            "links hold it up, and cloth would collapse",
                            "call attach() if it is cloth");
    }
    std::unique_ptr<cloth::Stepper> stepper =
        entry.factory ? entry.factory(*garment) : m_factory(*garment);
    if (!stepper)
        throw ArgumentError(cloth::softBodyName(body), "the stepper factory returned null",
                            "return a Stepper or throw an error that says why there is none");
    entry.step = std::make_unique<cloth::SoftBodyStep>(
        body, std::move(garment), std::move(stepper), m_settings.sleepMotion,
        m_settings.friction == btGnnFriction::bullet);
    entry.built = ++m_built;
    tellOfPlace(body);
    joinGoals(body, entry);
    entry.step->setRoot(entry.root);
    applyDetail(body, entry);
    entry.handover.end(body);
    if (body.getActivationState() == ISLAND_SLEEPING) body.activate();
    entry.stepping = Stepping::cloth;
}

/// The goals of a body as it is now: those that it has, or some that rest where its nodes are.
const std::shared_ptr<cloth::BodyGoals>& btGnnSoftBodySolver::goalsOf(const btSoftBody& body,
                                                                      Entry& entry) {
    if (!entry.goals || entry.goals->size() != body.m_nodes.size())
        entry.goals = std::make_shared<cloth::BodyGoals>(cloth::nodePositions(body));
    return entry.goals;
}

/// Goals stay when garment or stepper of a body change, and end with a change of its nodes.
void btGnnSoftBodySolver::joinGoals(btSoftBody& body, Entry& entry) {
    if (!entry.limits && !entry.goals) return;
    entry.step->setGoals(goalsOf(body, entry));
}

Garment btGnnSoftBodySolver::garmentFor(const btSoftBody& body, const Entry& entry) const {
    if (entry.given) return entry.given->with_pins(cloth::pinnedNodes(body));
    if (entry.fabric) return cloth::garmentOfSoftBody(body, *entry.fabric, false);
    if (m_settings.fabric)
        return cloth::garmentOfSoftBody(body, *m_settings.fabric, m_settings.useBodyDensity);
    return cloth::garmentOfSoftBody(body, cloth::fabricOfMaterials(body), false);
}

void btGnnSoftBodySolver::tryBuild(btSoftBody& body, Entry& entry) {
    try {
        build(body, entry);
    } catch (const std::exception& error) {
        say(error.what());
    }
}

/// Follows what the user did to a known body since the last world step.
void btGnnSoftBodySolver::refresh(btSoftBody& body, Entry& entry) {
    if (entry.detached) return;
    if (!cloth::isCloth(body)) {
        leaveToBullet(body, entry);
        entry.topology = 0;  // look again if it becomes cloth
        return;
    }
    const bool changed = cloth::topologySignature(body) != entry.topology;
    const bool healed = entry.stepping == Stepping::frozen && hasFiniteNodes(body);
    if (changed) followCut(body, entry);
    if (changed || healed) return tryBuild(body, entry);
    if (entry.stepping != Stepping::cloth) {
        if (!hasFiniteNodes(body)) entry.stepping = Stepping::frozen;
        return;
    }
    followScale(body, entry);
}

/// The garment with the nodes and faces that were added; none where it cannot be told, then it is
/// made anew.
void btGnnSoftBodySolver::followCut(btSoftBody& body, Entry& entry) {
    entry.given = nullptr;
    if (entry.limits && !areLimitsOf(body, *entry.limits)) {
        entry.limits.reset();
        entry.goals.reset();
        say(cloth::softBodyName(body) +
            ": its nodes were changed, so its skinned goals are gone. Remedy: call setGoalLimits() "
            "and setGoals() for the nodes of now");
    }
    if (!entry.step) return;
    try {
        std::optional<Garment> cut =
            cloth::garmentAfterCut(body, entry.step->garment(), entry.step->shown());
        if (cut) entry.given = std::make_shared<const Garment>(std::move(*cut));
    } catch (const ArgumentError&) {
        return;  // build() says what is wrong
    }
}

/// By how much the user has scaled the body since the last step: all rest lengths have changed by
/// one factor (setRestLengthScale()), or all are one factor times the lengths that were shown
/// (scale()). Others, such as setMass(), give them the lengths of now, each by another factor.
double btGnnSoftBodySolver::scaleOf(const btSoftBody& body, Entry& entry) const {
    std::vector<double> lengths = cloth::restLengths(body);
    std::optional<double> factor = cloth::commonFactor(entry.restLengths, lengths);
    if (!factor && lengths.size() == entry.restLengths.size())
        factor = cloth::commonFactor(cloth::lengthsAt(body, entry.step->shown()), lengths);
    entry.restLengths = std::move(lengths);
    return factor.value_or(1.0);
}

/// New pins or another size: the same rest shape in a new garment. Masses that are not finite
/// freeze the body, which has its rest shape again when they are mended.
void btGnnSoftBodySolver::followScale(btSoftBody& body, Entry& entry) {
    const double factor = scaleOf(body, entry);
    const bool scaled = std::abs(factor - 1.0) > 0.1;
    std::vector<int> pins = cloth::pinnedNodes(body);
    const Garment& old = entry.step->garment();
    if (!scaled && pins == old.pins() && hasFiniteMasses(body)) return;
    try {
        entry.given = std::make_shared<const Garment>(
            (scaled ? scaledGarment(old, factor) : old).with_pins(std::move(pins)));
        build(body, entry);
    } catch (const std::exception& error) {
        if (entry.stepping == Stepping::cloth) leaveToBullet(body, entry);
        entry.step.reset();
        say(error.what());
    }
}

void btGnnSoftBodySolver::optimize(btAlignedObjectArray<btSoftBody*>& softBodies,
                                   bool forceUpdate) {
    btDefaultSoftBodySolver::optimize(softBodies, forceUpdate);
    for (int i = 0; i < softBodies.size(); ++i) {
        btSoftBody& body = *softBodies[i];
        Entry& entry = entryOf(&body);
        entry.worldId = worldIdOf(body);
        entry.seen = true;
        refresh(body, entry);
        mendBounds(body);
    }
    for (auto it = m_entries.begin(); it != m_entries.end();) {
        const bool gone =
            it->second.seen &&
            softBodies.findLinearSearch(const_cast<btSoftBody*>(it->first)) == softBodies.size();
        it = gone ? m_entries.erase(it) : std::next(it);
    }
}

void btGnnSoftBodySolver::setGoalLimits(btSoftBody* body, const cloth::GoalLimits& limits) {
    if (!body) throw ArgumentError("setGoalLimits()", "the soft body is null", "create it first");
    cloth::check(limits, body->m_nodes.size(), cloth::softBodyName(*body));
    Entry& entry = entryToSet(*body);
    entry.limits.reset();
    if (!limits.empty()) entry.limits = limits;
    if (entry.step) tryBuild(*body, entry);
}

void btGnnSoftBodySolver::setGoals(btSoftBody* body, cloth::SkinGoals goals, double duration) {
    if (!body) throw ArgumentError("setGoals()", "the soft body is null", "create it first");
    checkGoals(*body, goals, duration);
    Entry& entry = entryToSet(*body);
    goalsOf(*body, entry);
    constexpr double kJump = 0.5;  // m: nobody moves as far between the end of a step and the next
    const double jump = std::sqrt((goals.x0 - entry.goals->now()).rowwise().squaredNorm().mean());
    if (entry.goals->given() && jump > kJump)
        say(cloth::softBodyName(*body) +
            ": its goals jumped by more than half a metre between two steps, and drag the cloth. "
            "Remedy: let x0 be the x1 of before; call teleport() where the character was put "
            "elsewhere");
    const bool moves = goals.x1 != entry.goals->now();
    entry.goals->set(std::move(goals), duration);
    if (entry.step) entry.step->setGoals(entry.goals);
    if (moves && entry.stepping == Stepping::cloth && body->getActivationState() == ISLAND_SLEEPING)
        body->activate();
}

cloth::RootMotion& btGnnSoftBodySolver::rootOf(Entry& entry) {
    if (!entry.root) entry.root = std::make_shared<cloth::RootMotion>();
    if (entry.step) entry.step->setRoot(entry.root);
    return *entry.root;
}

void btGnnSoftBodySolver::setInertia(btSoftBody* body, double linear, double angular) {
    if (!body) throw ArgumentError("setInertia()", "the soft body is null", "create it first");
    cloth::check_range(cloth::softBodyName(*body) + ": linear inertia", linear, 0.0, 1.0);
    cloth::check_range(cloth::softBodyName(*body) + ": angular inertia", angular, 0.0, 1.0);
    rootOf(entryToSet(*body)).setInertia(linear, angular);
}

void btGnnSoftBodySolver::setRootMotion(btSoftBody* body, const btTransform& from,
                                        const btTransform& to, double duration) {
    if (!body) throw ArgumentError("setRootMotion()", "the soft body is null", "create it first");
    if (!isFinite(from) || !isFinite(to) || !(duration >= 0.0) || std::isinf(duration))
        throw ArgumentError(cloth::softBodyName(*body) + ": setRootMotion()",
                            "a pose or the duration is not finite",
                            "check the animation before handing it over");
    if (!cloth::isRigid(from) || !cloth::isRigid(to))
        throw ArgumentError(cloth::softBodyName(*body) + ": setRootMotion()",
                            "a pose scales, shears or mirrors", "give the pose of the bone alone");
    rootOf(entryToSet(*body)).set(cloth::toPose(from), cloth::toPose(to), duration);
    if (body->getActivationState() == ISLAND_SLEEPING && !(from == to)) body->activate();
}

void btGnnSoftBodySolver::setDetail(btSoftBody* body, const btGnnDetail& detail) {
    if (!body) throw ArgumentError("setDetail()", "the soft body is null", "create it first");
    const std::string name = cloth::softBodyName(*body) + ": btGnnDetail.";
    cloth::check_range(name + "iterations", detail.iterations, 0, 1000);
    cloth::check_range(name + "worldSteps", detail.worldSteps, 1, 8);
    Entry& entry = entryToSet(*body);
    entry.detail = detail;
    if (entry.step) applyDetail(*body, entry);
}

void btGnnSoftBodySolver::applyDetail(const btSoftBody& body, Entry& entry) {
    const bool limited = entry.detail.iterations > 0;
    cloth::Stepper& stepper = entry.step->stepper();
    const bool known = stepper.set_max_iterations(limited ? entry.detail.iterations
                                                          : std::numeric_limits<int>::max());
    if (limited && !known)
        say(cloth::softBodyName(body) + ": its stepper " + stepper.name() +
            " has no iterations that setDetail() could limit. Remedy: give it another stepper, or "
            "a longer cloth step by btGnnDetail::worldSteps");
    entry.step->setRate(entry.detail.worldSteps);
}

void btGnnSoftBodySolver::follow(btSoftBody* body, std::shared_ptr<cloth::Follower> follower) {
    if (!body) throw ArgumentError("follow()", "the soft body is null", "create it first");
    if (follower && follower->simulated_size() != body->m_nodes.size())
        throw ArgumentError(cloth::softBodyName(*body) + ": follow()",
                            "the follower is of " + std::to_string(follower->simulated_size()) +
                                " vertices, the body has " + std::to_string(body->m_nodes.size()) +
                                " nodes",
                            "make it for the mesh of the body, garmentOf(body)->rest()");
    Entry& entry = entryToSet(*body);
    entry.follower = std::move(follower);
    if (entry.follower) entry.follower->show(shownPositions(body), {}, {});
}

const cloth::Follower* btGnnSoftBodySolver::followerOf(const btSoftBody* body) const {
    const auto it = m_entries.find(body);
    return it != m_entries.end() ? it->second.follower.get() : nullptr;
}

void btGnnSoftBodySolver::showFollower(const btSoftBody& body, Entry& entry) {
    if (entry.follower && entry.follower->simulated_size() != body.m_nodes.size()) {
        entry.follower.reset();
        say(cloth::softBodyName(body) +
            ": its nodes were changed, so the mesh that follows it stays where it is. "
            "Remedy: make one for the nodes of now, and call follow() with it");
    }
    if (!entry.follower && !entry.blend) return;
    const cloth::Points nodes = cloth::nodePositions(body);
    if (nodes.rows() == 0 || !nodes.allFinite()) return;
    const auto begin = std::chrono::steady_clock::now();
    const bool isCloth = entry.stepping == Stepping::cloth;
    static const std::vector<cloth::LimbSet> none;
    const auto& ignored = isCloth ? entry.step->stepper().ignored_limbs() : none;
    const cloth::Points skin =
        isCloth && entry.blend ? goalsOf(body, entry)->now() : cloth::Points();
    const cloth::Boundary boundary =
        cloth::obstaclesAround(body, {&nodes, &skin}, m_obstacles, m_h);
    if (entry.blend) {
        entry.blend->advance(m_h);
        entry.blend->follow(nodes, skin, boundary, ignored);
    }
    if (entry.follower)
        entry.follower->show(entry.blend ? entry.blend->vertices() : nodes, boundary, ignored);
    if (entry.blend && entry.blend->weight() == 0.0 && !entry.blend->is_fading())
        entry.blend.reset();  // it costs nothing again
    const std::chrono::duration<double, std::milli> passed =
        std::chrono::steady_clock::now() - begin;
    m_status.times.contact += passed.count();
}

/// At once, between world steps: what is shown is out of the obstacles after the next one.
void btGnnSoftBodySolver::showWithoutObstacles(const btSoftBody& body, Entry& entry) {
    const cloth::Points nodes = cloth::nodePositions(body);
    if (entry.blend) entry.blend->follow(nodes, goalsOf(body, entry)->now(), {});
    if (entry.follower && entry.follower->simulated_size() == body.m_nodes.size())
        entry.follower->show(entry.blend ? entry.blend->vertices() : nodes, {}, {});
}

void btGnnSoftBodySolver::fadeToSkin(btSoftBody* body, double weight, double seconds) {
    if (!body) throw ArgumentError("fadeToSkin()", "the soft body is null", "create it first");
    Entry& entry = entryToSet(*body);
    const auto blend = entry.blend ? entry.blend : std::make_shared<cloth::SkinBlend>();
    blend->fade_to(weight, seconds);
    if (!entry.blend) blend->follow(cloth::nodePositions(*body), {}, {});
    entry.blend = blend;
    goalsOf(*body, entry);
    if (entry.step) entry.step->setGoals(entry.goals);
    if (body->getActivationState() == ISLAND_SLEEPING) body->activate();
}

cloth::Points btGnnSoftBodySolver::shownPositions(const btSoftBody* body) const {
    if (!body) throw ArgumentError("shownPositions()", "the soft body is null", "create it first");
    const auto it = m_entries.find(body);
    const bool is_mixed = it != m_entries.end() && it->second.blend &&
                          it->second.blend->vertices().rows() == body->m_nodes.size();
    return is_mixed ? it->second.blend->vertices() : cloth::nodePositions(*body);
}

void btGnnSoftBodySolver::teleport(btSoftBody* body, const btTransform& motion,
                                   btGnnTeleport kind) {
    if (!body) throw ArgumentError("teleport()", "the soft body is null", "create it first");
    if (!isFinite(motion))
        throw ArgumentError(cloth::softBodyName(*body) + ": teleport()", "the motion is not finite",
                            "give the motion from the old place to the new one");
    if (!cloth::isRigid(motion))
        throw ArgumentError(cloth::softBodyName(*body) + ": teleport()",
                            "the motion scales, shears or mirrors",
                            "give one that turns and moves; scale() the body to change its size");
    Entry& entry = entryToSet(*body);
    entry.placed = true;
    // What was cut is told by where the nodes were shown.
    if (entry.step && cloth::topologySignature(*body) != entry.topology) refresh(*body, entry);
    const bool has_goals = entry.limits || (entry.goals && entry.goals->given());
    const bool on_goals = kind == btGnnTeleport::reset && has_goals;
    if (kind == btGnnTeleport::reset && !has_goals)
        say(cloth::softBodyName(*body) +
            ": teleport() by reset has no goals to put it on, and lets it keep its shape. "
            "Remedy: give goals by setGoals() before");
    const cloth::Points places =
        on_goals ? goalsOf(*body, entry)->now() : cloth::nodePositions(*body);
    for (int i = 0; i < body->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body->m_nodes[i];
        node.m_x = motion * cloth::toBullet(cloth::Vec3(places.row(i)));
        node.m_q = node.m_x;
        node.m_v = kind == btGnnTeleport::reset ? btVector3(0, 0, 0) : motion.getBasis() * node.m_v;
    }
    if (entry.goals) entry.goals->move(cloth::toPose(motion));
    if (entry.step) entry.step->restart();
    body->updateNormals();
    body->updateBounds();
    tellOfPlace(*body);
    showWithoutObstacles(*body, entry);
    if (body->getActivationState() == ISLAND_SLEEPING) body->activate();
}

/// Skin that has moved since the last step does not pass through cloth that was not there.
void btGnnSoftBodySolver::tellOfPlace(const btSoftBody& body) {
    btVector3 low, high;
    body.getAabb(low, high);
    m_obstacles.clothWasPlaced(cloth::toVec3(low), cloth::toVec3(high));
}

/// Of skin that was put elsewhere without its cloth.
void btGnnSoftBodySolver::tellOfJumps(const btSoftBody& body, Entry& entry) {
    const bool placed = std::exchange(entry.placed, false);
    if (placed || entry.stepping != Stepping::cloth) return;
    btVector3 low, high;
    body.getAabb(low, high);
    if (m_obstacles.anyJumpsFrom(cloth::toVec3(low), cloth::toVec3(high)))
        say(cloth::softBodyName(body) +
            ": an animated obstacle at it jumped by more than half a metre between two steps, and "
            "leaves it behind or drags it. Remedy: let x0 be the x1 of before; call teleport() "
            "where the character was put elsewhere");
}

btGnnSoftBodySolver::Stepping btGnnSoftBodySolver::steppingOf(const btSoftBody* body) const {
    const auto it = m_entries.find(body);
    return it == m_entries.end() ? Stepping::bullet : it->second.stepping;
}

void btGnnSoftBodySolver::predictMotion(btScalar solverdt) {
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        btSoftBody& body = *m_softBodySet[i];
        if (steppingOf(&body) != Stepping::bullet || !body.isActive()) continue;
        m_entries[&body].handover.beforeStep(body, static_cast<double>(solverdt));
        body.predictMotion(solverdt);
        mendBounds(body);
    }
}

void btGnnSoftBodySolver::solveConstraints(btScalar solverdt) {
    m_h = static_cast<double>(solverdt);
    const FiniteGravity gravity(m_softBodySet);
    for (const btSoftBody* body : gravity.bodies())
        if (isStepped(body))
            say(cloth::softBodyName(*body) +
                ": gravity is not finite, and counts as 0. Remedy: check what the program gives to "
                "btSoftBodyWorldInfo::m_gravity");
    m_obstacles.beginStep(m_h);
    m_status.clothBodies = m_status.bulletBodies = 0;
    m_status.sleepingBodies = m_status.frozenBodies = m_status.carriedBodies = 0;
    m_status.maxPenetration = m_status.maxIgnoredDepth = 0.0;
    m_status.nodesInIgnoredLimbs = 0;
    m_status.touchingPairs = m_status.passedPairs = 0;
    m_status.times = {};
    const std::vector<std::vector<Stepped>> meeting = findMeetingCloth();
    const bool limited = !std::isinf(m_settings.maxMs);
    const cloth::Deadline deadline =
        limited ? cloth::Deadline::in(m_settings.maxMs) : cloth::Deadline();
    int waiting = limited ? activeCloth() : 0;
    std::vector<Stepped> together;
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        btSoftBody& body = *m_softBodySet[i];
        Entry& entry = m_entries[&body];
        m_status.clothBodies += entry.stepping == Stepping::cloth;
        m_status.bulletBodies += entry.stepping == Stepping::bullet;
        m_status.frozenBodies += entry.stepping == Stepping::frozen;
        tellOfJumps(body, entry);
        if (entry.stepping == Stepping::cloth && body.getActivationState() == ISLAND_SLEEPING &&
            entry.step->sleepsOn(m_obstacles)) {
            ++m_status.sleepingBodies;
            m_status.maxPenetration = std::max(m_status.maxPenetration, entry.step->shownDepth());
        }
        if (!body.isActive()) {
            if (entry.blend && entry.blend->is_fading()) showFollower(body, entry);
            continue;
        }
        if (entry.stepping == Stepping::bullet) {
            body.solveConstraints();
            entry.handover.afterStep(body, static_cast<double>(solverdt));
        }
        if (entry.stepping != Stepping::cloth) continue;
        if (!entry.detail.stepped) {
            ++m_status.carriedBodies;
            entry.step->carry(m_h);
            showFollower(body, entry);
            continue;
        }
        if (limited)
            entry.step->setDeadline(cloth::Deadline::in(deadline.left() / std::max(1, waiting--)));
        const Stepped cloth{&body, &entry};
        const bool begun =
            entry.step->begin(static_cast<double>(solverdt), m_obstacles, m_settings.obstacleReach);
        if (begun && m_settings.parallel && !limited && entry.step->isIndependent(m_obstacles))
            together.push_back(cloth);
        else
            stepTogether({cloth});
    }
    stepTogether(together);
    for (const std::vector<Stepped>& group : meeting) resolveContacts(group);
    for (const std::string& message : m_obstacles.takeMessages()) say(message);
}

int btGnnSoftBodySolver::activeCloth() const {
    int count = 0;
    for (int i = 0; i < m_softBodySet.size(); ++i)
        count += isStepped(m_softBodySet[i]) && m_softBodySet[i]->isActive();
    return count;
}

bool btGnnSoftBodySolver::isStepped(const btSoftBody* body) const {
    const auto it = m_entries.find(body);
    return it != m_entries.end() && it->second.stepping == Stepping::cloth &&
           it->second.detail.stepped;
}

/// The rest of a world step that has begun. A body may take several cloth steps in it: they are
/// solved in rounds.
void btGnnSoftBodySolver::stepTogether(const std::vector<Stepped>& cloth) {
    std::vector<cloth::SoftBodyStep*> due;
    for (const Stepped& one : cloth) due.push_back(one.entry->step.get());
    while (!due.empty()) {
        due.erase(std::remove_if(due.begin(), due.end(),
                                 [&](auto* step) { return !step->beginClothStep(m_obstacles); }),
                  due.end());
        cloth::solveSteps(due);
        for (cloth::SoftBodyStep* step : due) step->endClothStep(m_obstacles);
    }
    for (const Stepped& one : cloth) {
        one.entry->waits = one.entry->meets;
        if (one.entry->waits)
            one.entry->step->handOver(m_obstacles);
        else
            finishStep(one);
    }
}

/// Groups of cloth that may touch in this world step. What moves wakes what it may touch.
std::vector<std::vector<btGnnSoftBodySolver::Stepped>> btGnnSoftBodySolver::findMeetingCloth() {
    std::vector<Stepped> cloth;
    std::vector<const btSoftBody*> bodies;
    for (int i = 0; m_contacts && i < m_softBodySet.size(); ++i) {
        btSoftBody* const body = m_softBodySet[i];
        if (!isStepped(body)) continue;
        cloth.push_back({body, &m_entries[body]});
        bodies.push_back(body);
    }
    std::vector<std::vector<Stepped>> result;
    if (cloth.empty()) return result;
    m_contacts->beginStep(m_h);
    std::vector<char> meets(cloth.size(), 0);
    for (const std::vector<size_t>& group : m_contacts->groups(bodies)) {
        const bool moves = std::any_of(group.begin(), group.end(), [&](size_t k) {
            return bodies[k]->isActive() && bodies[k]->getActivationState() != WANTS_DEACTIVATION;
        });
        result.emplace_back();
        for (const size_t k : group) {
            if (moves && !bodies[k]->isActive()) cloth[k].body->activate();
            meets[k] = 1;
            result.back().push_back(cloth[k]);
        }
    }
    for (size_t k = 0; k < cloth.size(); ++k) {
        cloth[k].entry->meets = meets[k] != 0;
        cloth[k].entry->step->setMeeting(meets[k] != 0);
    }
    for (const auto& group : result) {
        std::vector<cloth::ClothContacts::Member> members;
        for (const Stepped& one : group)
            if (one.body->isActive())
                members.push_back({one.body, one.entry->step.get(), one.entry->built});
        m_contacts->expect(members);
    }
    return result;
}

/// Contact between bodies that have been stepped; the rest of their world steps.
void btGnnSoftBodySolver::resolveContacts(std::vector<Stepped> group) {
    group.erase(std::remove_if(group.begin(), group.end(),
                               [](const Stepped& one) { return !one.entry->waits; }),
                group.end());
    std::vector<cloth::ClothContacts::Member> members;
    for (const Stepped& one : group)
        if (one.entry->step->isStepping())
            members.push_back({one.body, one.entry->step.get(), one.entry->built});
    if (members.size() > 1) {
        const auto begin = std::chrono::steady_clock::now();
        cloth::ClothContacts::Report report;
        try {
            report = m_contacts->resolve(members, m_obstacles);
        } catch (const std::exception& error) {
            say(error.what());
        }
        const std::chrono::duration<double, std::milli> passed =
            std::chrono::steady_clock::now() - begin;
        m_status.times.contact += passed.count();
        m_status.touchingPairs += report.pairs;
        m_status.passedPairs += report.left;
        if (report.left > 0)
            say(cloth::softBodyName(*members.front().body) + " and " +
                std::to_string(members.size() - 1) +
                " others near it: there is no room for all of them, so they pass through each "
                "other. Remedy: smaller time steps, or a smaller layerThickness");
    }
    for (const Stepped& one : group) {
        one.entry->waits = false;
        finishStep(one);
    }
}

void btGnnSoftBodySolver::finishStep(const Stepped& cloth) {
    btSoftBody& body = *cloth.body;
    Entry& entry = *cloth.entry;
    const cloth::SoftBodyStep::Result result = entry.step->end(m_obstacles);
    m_status.steps += result.steps;
    m_status.failedSteps += result.failed_steps;
    if (result.restored_nodes > 0)
        say(cloth::softBodyName(body) +
            ": nodes had positions or velocities that are not finite and were put back. Remedy: "
            "check what the program writes to m_x and m_v");
    if (result.steps > 0) {
        const cloth::StepReport& report = entry.step->lastReport();
        m_status.cutSteps += report.substeps > 1;
        m_status.shortenedSteps += report.out_of_time;
        m_status.maxIgnoredDepth = std::max(m_status.maxIgnoredDepth, report.max_ignored_depth);
        m_status.nodesInIgnoredLimbs += report.vertices_in_ignored_limbs;
        m_status.times += report.times;
        entry.failures = result.failed_steps > 0 ? entry.failures + result.failed_steps : 0;
    }
    m_status.maxPenetration = std::max(m_status.maxPenetration, entry.step->shownDepth());
    for (const std::string& trouble : troublesOf(body, entry.step->stepper(), result)) say(trouble);
    showFollower(body, entry);
    if (entry.failures >= m_settings.maxFailedSteps)
        giveUp(body, entry,
               "its stepper " + entry.step->stepper().name() + " failed " +
                   std::to_string(entry.failures) + " times in a row");
}

void btGnnSoftBodySolver::giveUp(btSoftBody& body, Entry& entry, const std::string& why) {
    say(cloth::softBodyName(body) + ": " + why +
        "; Bullet steps it from now on. Remedy: call attach() to try again");
    leaveToBullet(body, entry);
    entry.detached = true;
}

void btGnnSoftBodySolver::updateSoftBodies() {
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        btSoftBody& body = *m_softBodySet[i];
        if (steppingOf(&body) != Stepping::bullet || !body.isActive()) continue;
        body.integrateMotion();
        showFollower(body, m_entries[&body]);
    }
}

void btGnnSoftBodySolver::processCollision(btSoftBody* body,
                                           const btCollisionObjectWrapper* object) {
    if (steppingOf(body) == Stepping::bullet && fitsDistanceField(*body) &&
        isFinite(object->getWorldTransform()))
        body->defaultCollisionHandler(object);
}

void btGnnSoftBodySolver::processCollision(btSoftBody* body, btSoftBody* otherBody) {
    const bool isCloth = steppingOf(body) == Stepping::cloth;
    const bool isOtherCloth = steppingOf(otherBody) == Stepping::cloth;
    if (isCloth && isOtherCloth && m_contacts) return;
    if (steppingOf(body) == Stepping::bullet && steppingOf(otherBody) == Stepping::bullet)
        body->defaultCollisionHandler(otherBody);
    else if (wouldCollide(*body, *otherBody))
        say((isCloth ? cloth::softBodyName(*body) : cloth::softBodyName(*otherBody)) +
            ": it meets " +
            (isCloth ? cloth::softBodyName(*otherBody) : cloth::softBodyName(*body)) +
            ", and both ask for contact between soft bodies (VF_SS or CL_SS), but cloth passes "
            "through soft bodies. Remedy: btGnnSolverSettings::layerThickness where both are "
            "cloth, "
            "merge_garments() for layers of one character, a rigid body or setAnimatedObstacle() "
            "for what lies below, or detach() both");
}

const cloth::Stepper* btGnnSoftBodySolver::stepperOf(const btSoftBody* body) const {
    const auto it = m_entries.find(body);
    return it != m_entries.end() && it->second.step ? &it->second.step->stepper() : nullptr;
}

const Garment* btGnnSoftBodySolver::garmentOf(const btSoftBody* body) const {
    const auto it = m_entries.find(body);
    return it != m_entries.end() && it->second.step ? &it->second.step->garment() : nullptr;
}

const cloth::StepReport* btGnnSoftBodySolver::reportOf(const btSoftBody* body) const {
    const auto it = m_entries.find(body);
    return it != m_entries.end() && it->second.step ? &it->second.step->lastReport() : nullptr;
}

void btGnnSoftBodySolver::setAnimatedObstacle(
    const btCollisionObject* object, std::shared_ptr<const cloth::Faces> faces, cloth::Points x0,
    cloth::Points x1, double duration, std::shared_ptr<const std::vector<std::uint8_t>> limbs) {
    m_obstacles.setAnimated(
        object, {std::move(faces), std::move(x0), std::move(x1), duration, std::move(limbs)});
}

void btGnnSoftBodySolver::removeAnimatedObstacle(const btCollisionObject* object) {
    m_obstacles.removeAnimated(object);
}

void btGnnSoftBodySolver::say(const std::string& text) {
    for (btGnnSolverMessage& message : m_status.messages)
        if (message.text == text) {
            ++message.count;
            return;
        }
    constexpr size_t kMaxMessages = 100;
    if (m_status.messages.size() < kMaxMessages) m_status.messages.push_back({text, 1});
}
