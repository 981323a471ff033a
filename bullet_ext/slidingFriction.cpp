#include "bullet_ext/slidingFriction.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bullet_ext/softBodyGarment.h"

namespace cloth {

namespace {

// Contacts keep cloth at 4 mm, and steppers rub what is nearer than this.
constexpr double kRubbed = 5e-3;  // m

struct Touch {
    const SlidingSolid* solid = nullptr;
    double distance = 0.0;  ///< (m)
};

struct Brake {
    Vec3 change = Vec3::Zero();  ///< of the velocity (m/s)
    bool holds = false;          ///< it takes back the motion of the step, too
};

struct Slider {
    const SlidingSolid* solid;
    int node;
    double mass;  ///< (kg)
    Brake brake;
};

/// What lies on a round solid is held by the middles of its edges: its nodes are as far away as
/// the chord is from the arc, an eighth of the edge's length where that is the solid's radius.
double reachOf(const Garment& garment) {
    return kRubbed + 0.1 * garment.mean_edge_length();
}

Touch touchOf(const SlidingStep& step, const Vec3& x, double reach) {
    Touch touch{nullptr, reach};
    for (const SlidingSolid& solid : step.solids) {
        const std::optional<double> distance = solid.near.distance(x, reach);
        if (distance && *distance < touch.distance) touch = {&solid, *distance};
    }
    return touch;
}

Vec3 along(const Vec3& velocity, const Vec3& normal) {
    return velocity - velocity.dot(normal) * normal;
}

/// Of one node on what it touches.
struct Contact {
    Vec3 normal, gravity;  ///< the second is that of the step (m/s)
    Vec3 before, slip;     ///< velocity over the solid's, before and after the step (m/s)
    double coefficient;
    bool rubbed;   ///< the stepper has given Coulomb's friction already
    bool pressed;  ///< by the cloth around it

    bool leaves() const {
        constexpr double kLeaves = 1e-3;  // m/s
        return normal.isZero() || slip.dot(normal) > kLeaves - gravity.dot(normal);
    }
    bool sticks() const {
        const Vec3 free = before + gravity;
        return along(free, normal).norm() < -coefficient * free.dot(normal);
    }
};

/// What friction takes off the node's velocity beyond what the stepper has taken already.
Brake braking(const Contact& contact, int iterations, double world_steps) {
    const Vec3 sliding = along(contact.slip, contact.normal);
    if (contact.sticks()) return {(1.0 / iterations - 1.0) * sliding, true};
    const double speed = sliding.norm();
    const double repetitions = (contact.pressed ? iterations : 1) * world_steps;
    const double share = 1.0 - std::pow(1.0 - contact.coefficient, repetitions);
    const double coulomb =
        contact.coefficient * std::max(0.0, -contact.gravity.dot(contact.normal));
    const double taken = contact.rubbed ? coulomb : 0.0;
    const double more = std::min(std::max(coulomb, share * (speed + taken)) - taken, speed);
    return {more > 0.0 ? Vec3(-(more / speed) * sliding) : Vec3::Zero(), contact.pressed};
}

std::vector<Slider> findSliders(const btSoftBody& body, const SlidingStep& step) {
    const double reach = reachOf(step.garment), mass_ratio = massRatio(body, step.garment);
    const Vec3 gravity = step.length * toVec3(body.m_worldInfo->m_gravity);
    const int iterations = std::max(1, body.m_cfg.piterations);
    Points forces;
    std::optional<bool> forces_known;  // asked for once a node touches something
    std::vector<Slider> sliders;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        if (step.garment.is_pinned()[static_cast<size_t>(i)]) continue;
        const Vec3 x = step.to.x.row(i);
        const Touch touch = touchOf(step, x, reach);
        if (!touch.solid) continue;
        const Vec3 carried = touch.solid->velocity(x);
        Contact contact{touch.solid->near.outward(x, reach),
                        gravity,
                        Vec3(step.from.v.row(i)) - carried,
                        Vec3(step.to.v.row(i)) - carried,
                        usableFriction(body.m_cfg.kDF) * touch.solid->friction,
                        touch.distance < kRubbed,
                        false};
        contact.coefficient = std::clamp(contact.coefficient, 0.0, 1.0);
        if (contact.leaves()) continue;
        const double weight = step.garment.masses()[i] * gravity.norm() / step.length;
        if (!forces_known) forces_known = step.stepper.internal_forces(step.to.x, forces);
        if (*forces_known) contact.pressed = forces.row(i).dot(contact.normal) < -0.1 * weight;
        const Brake brake = braking(contact, iterations, step.length / step.world_step);
        if (!brake.change.isZero(0.0))
            sliders.push_back({touch.solid, i, mass_ratio * step.garment.masses()[i], brake});
    }
    return sliders;
}

/// Velocity that all impulses give to the body at most, over that which they take off the cloth.
double recoil(const std::vector<Slider>& sliders, const SlidingSolid& solid, const Points& x) {
    const btRigidBody& body = *solid.near.body;
    double mass = 0.0, farthest = 0.0;
    for (const Slider& slider : sliders) {
        if (slider.solid != &solid) continue;
        const Vec3 arm = Vec3(x.row(slider.node)) - toVec3(body.getCenterOfMassPosition());
        mass += slider.mass;
        farthest = std::max(farthest, arm.squaredNorm());
    }
    const double turning = toMatrix(body.getInvInertiaTensorWorld()).norm() * farthest;
    return mass * (static_cast<double>(body.getInvMass()) + turning);
}

void push(btRigidBody& body, const Vec3& impulse, const Vec3& point) {
    const Vec3 arm = point - toVec3(body.getCenterOfMassPosition());
    body.applyImpulse(toBullet(impulse), toBullet(arm));
}

/// Takes back the motion of the step that friction forbids, unless that is deeper in the solid.
void putBack(const SlidingStep& step, const Slider& slider) {
    const Vec3 x = step.to.x.row(slider.node), back = x + step.length * slider.brake.change;
    const double radius = reachOf(step.garment) + (back - x).norm();
    const std::optional<double> now = slider.solid->near.distance(x, radius);
    const std::optional<double> then = slider.solid->near.distance(back, radius);
    if (now && then && *then >= std::min(*now, kRubbed)) step.to.x.row(slider.node) = back;
}

double motionOf(const SlidingStep& step) {
    return 0.5 * step.garment.masses().dot(step.to.v.rowwise().squaredNorm());
}

/// Cloth that lands in a long step is stopped in part: taken back all the way, that would stretch
/// the rest by more than the motion which friction took. Cloth that rests has the energy of the
/// start of the step again.
/// @param x      positions before any was taken back (|V| x 3, m)
/// @param taken  energy of motion (J)
void limitStretch(const SlidingStep& step, const Points& x, double taken) {
    if (x == step.to.x) return;
    const auto energy = [&](const Points& at) {
        return step.stepper.internal_energy(at).value_or(0.0);
    };
    const Points back = step.to.x - x;
    const double before = energy(x);
    std::optional<double> at_start;  // asked for where the end does not allow it
    for (const double part : {1.0, 0.5, 0.25}) {
        step.to.x = x + part * back;
        const double now = energy(step.to.x);
        if (now <= before + taken) return;
        if (!at_start) at_start = energy(step.from.x);
        if (now <= *at_start + taken) return;
    }
    step.to.x = x;
}

}  // namespace

void applySlidingFriction(btSoftBody& body, const SlidingStep& step) {
    if (step.solids.empty() || !(body.m_cfg.kDF > 0)) return;
    const std::vector<Slider> sliders = findSliders(body, step);
    if (sliders.empty()) return;
    const double motion = motionOf(step);
    const Points x = step.to.x;
    for (const SlidingSolid& solid : step.solids) {
        const double part = solid.near.body ? 1.0 / (1.0 + recoil(sliders, solid, step.to.x)) : 1.0;
        for (const Slider& slider : sliders) {
            const Vec3 change = part * slider.brake.change, impulse = slider.mass * change;
            if (slider.solid != &solid || !fitsFloats(impulse)) continue;
            step.to.v.row(slider.node) += change.transpose();
            if (solid.near.body) push(*solid.near.body, -impulse, step.to.x.row(slider.node));
            if (!solid.near.body && slider.brake.holds) putBack(step, slider);
        }
    }
    limitStretch(step, x, motion - motionOf(step));
    if (Points& slip = step.to.stick.slip; slip.rows() == x.rows()) slip += step.to.x - x;
}

}  // namespace cloth
