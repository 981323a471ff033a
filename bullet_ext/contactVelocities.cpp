#include "bullet_ext/contactVelocities.h"

#include <algorithm>
#include <cmath>

namespace cloth {

namespace {

constexpr double kSnap = 100.0;  // m/s^2: cloth that is let go moves with no more at first
constexpr double kNear = 2e-2;   // m: surfaces that touch cloth are not farther from it

void calmPinched(const ClothStep& step, int node) {
    const auto i = static_cast<size_t>(node);
    const NearSolid& keeper = step.near[static_cast<size_t>(step.pinched.keeper()[i])];
    const NearSolid& pincher = step.near[static_cast<size_t>(step.pinched.pincher()[i])];
    const Vec3 place = step.to.x.row(node), ground = keeper.velocity(place, step.length);
    const Vec3 other = pincher.velocity(place, step.length) - ground;
    const Vec3 out = keeper.outward(place, kNear);
    Vec3 slip = Vec3(step.to.v.row(node)) - ground;
    slip -= slip.dot(out) * out;
    const double most = (other - other.dot(out) * out).norm();
    if (slip.norm() > most) slip *= most / slip.norm();
    step.to.v.row(node) = ground + slip;
}

}  // namespace

void calmContacts(const ClothStep& step, const ClothTouches& touches, const Points& free) {
    for (int i = 0; i < static_cast<int>(free.rows()); ++i) {
        if (step.garment.is_pinned()[static_cast<size_t>(i)]) continue;
        if (step.pinched.keeper()[static_cast<size_t>(i)] >= 0) {
            calmPinched(step, i);
            continue;
        }
        if (touches.solid[static_cast<size_t>(i)] < 0) continue;
        const NearSolid& solid =
            step.near[static_cast<size_t>(touches.solid[static_cast<size_t>(i)])];
        const Vec3 place = touches.place.row(i), out = solid.outward(place, kNear);
        const Vec3 velocity = step.to.v.row(i);
        const double leaves = (velocity - solid.velocity(place, step.length)).dot(out);
        const double pushed = (velocity - Vec3(free.row(i))).dot(out);
        const double excess = std::min(leaves, pushed);
        if (excess > 0.0) step.to.v.row(i) -= excess * out.transpose();
    }
}

void capSpeeds(const ClothStep& step, const ClothTouches& touches, const Points& free) {
    double fastest = std::sqrt(step.from.v.rowwise().squaredNorm().maxCoeff());
    for (int i = 0; i < static_cast<int>(free.rows()); ++i) {
        const int s = touches.solid[static_cast<size_t>(i)];
        if (s < 0) continue;
        const NearSolid& solid = step.near[static_cast<size_t>(s)];
        fastest = std::max(fastest, solid.velocity(touches.place.row(i), step.length).norm());
    }
    for (int pin : step.garment.pins()) fastest = std::max(fastest, step.to.v.row(pin).norm());
    for (int i = 0; i < static_cast<int>(free.rows()); ++i) {
        const double most =
            std::max(fastest, std::min(free.row(i).norm(), fastest + kSnap * step.length));
        const double speed = step.to.v.row(i).norm();
        if (speed > most) step.to.v.row(i) *= most / speed;
    }
}

}  // namespace cloth
