#include "bullet_ext/energyBalance.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

#include "bullet_ext/surplusEnergy.h"

namespace cloth {

namespace {

double motionAndHeight(const ClothStep& step, const VectorX& masses, const ClothState& state) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < masses.size(); ++i)
        sum += masses[i] *
               (0.5 * state.v.row(i).squaredNorm() - step.boundary.gravity.dot(state.x.row(i)));
    return sum;
}

/// Takes energy from the motion of nodes that are not pinned. Returns what is left.
double calmCloth(const ClothStep& step, const EnergyBalance::Cloth& cloth, double surplus) {
    VectorX masses = cloth.masses;
    for (const int pin : step.garment.pins()) masses[pin] = 0.0;
    return takeFromMotion(surplus, masses, cloth.floats, step.to.v);
}

/// Takes the same part of what each body gains.
double limitGains(std::vector<EnergyBalance::Share>& shares, double surplus) {
    double gains = 0.0;
    for (const auto& share : shares) gains += std::max(0.0, gainOf(*share.body, *share.impulse));
    if (!(surplus > 0.0) || !(gains > 0.0)) return surplus;
    const double taken = std::min(surplus, gains);
    for (auto& share : shares) {
        const double gain = std::max(0.0, gainOf(*share.body, *share.impulse));
        *share.impulse *= partThatGains(*share.body, *share.impulse, (1.0 - taken / gains) * gain);
    }
    return surplus - taken;
}

/// Takes the same part of the motion of each body that the cloth is anchored to.
double brake(std::vector<EnergyBalance::Share>& shares, double surplus) {
    const auto motionAfter = [](const EnergyBalance::Share& share) -> Vector6 {
        return massMatrix(*share.body) * motionOf(*share.body) + *share.impulse;
    };
    double moving = 0.0;
    for (const auto& share : shares)
        if (share.anchored) {
            const Vector6 after = motionAfter(share);
            moving += 0.5 * after.dot(solve(massMatrix(*share.body), after));
        }
    if (!(surplus > 0.0) || !(moving > 0.0)) return surplus;
    const double taken = std::min(surplus, moving), kept = std::sqrt(1.0 - taken / moving);
    for (auto& share : shares)
        if (share.anchored) *share.impulse -= (1.0 - kept) * motionAfter(share);
    return surplus - taken;
}

/// Takes the same part of the motion of each body against what the cloth gives it.
double stopPressing(std::vector<EnergyBalance::Share>& shares, double surplus) {
    const auto pressing = [](const EnergyBalance::Share& share) -> Vec3 {
        const Vec3 push = share.impulse->head<3>().stableNormalized();
        const Vec3 after =
            (motionOf(*share.body) + solve(massMatrix(*share.body), *share.impulse)).head<3>();
        return std::max(0.0, -after.dot(push)) * push;
    };
    const auto mass = [](const EnergyBalance::Share& share) {
        return 1.0 / static_cast<double>(share.body->getInvMass());
    };
    double moving = 0.0;
    for (const auto& share : shares)
        if (!share.anchored) moving += 0.5 * mass(share) * pressing(share).squaredNorm();
    if (!(surplus > 0.0) || !(moving > 0.0)) return surplus;
    const double taken = std::min(surplus, moving), kept = std::sqrt(1.0 - taken / moving);
    for (auto& share : shares)
        if (!share.anchored)
            share.impulse->head<3>() += (1.0 - kept) * mass(share) * pressing(share);
    return surplus - taken;
}

/// Energy of the cloth at rest (J).
double energyAt(const ClothStep& step, const EnergyBalance::Cloth& cloth, const Points& x) {
    return cloth.mass_ratio * step.stepper.internal_energy(x).value_or(0.0) -
           cloth.masses.dot(x * step.boundary.gravity);
}

/// What lifts the cloth by a hundredth of its edges (J).
double smallLift(const ClothStep& step, const EnergyBalance::Cloth& cloth) {
    return 0.01 * step.garment.mean_edge_length() * step.boundary.gravity.norm() *
           cloth.masses.sum();
}

/// What a step of Bullet's loses of the energy of a body that falls (J): half m (g h)^2. What holds
/// the body up gives that back.
double lostInFall(const EnergyBalance::Share& share, double length) {
    const double change = length * static_cast<double>(share.body->getGravity().length());
    return 0.5 * change * change / static_cast<double>(share.body->getInvMass());
}

/// Takes energy from the way that the cloth went, as far as that gets.
TakenWay holdBack(const ClothStep& step, const EnergyBalance::Cloth& cloth, double surplus) {
    Points from = step.from.x;
    for (const int pin : step.garment.pins()) from.row(pin) = step.to.x.row(pin);
    const auto energy = [&](const Points& x) { return energyAt(step, cloth, x); };
    return takeFromWay(surplus, {0.5, 0.25, 0.0}, energy, from, step.to.x);
}

}  // namespace

/// What the body gained in the last cloth step, as far as others have taken it since (J).
double EnergyBalance::borneBefore(const Share& share, double length) const {
    const auto found = m_pushed.find(share.body);
    if (share.anchored || found == m_pushed.end()) return 0.0;
    Vector6 expected = found->second.after;
    expected.head<3>() += length * toVec3(share.body->getGravity());
    const Matrix6 mass = massMatrix(*share.body);
    const double lost = kineticEnergy(mass, expected) - kineticEnergy(mass, motionOf(*share.body));
    return std::max(0.0, std::min(lost, found->second.gain));
}

EnergyBalance::Result EnergyBalance::settle(const ClothStep& step, const Cloth& cloth,
                                            std::vector<Share>& shares) {
    const Result result = balance(step, cloth, shares);
    m_pushed.clear();
    for (const Share& share : shares)
        m_pushed[share.body] = {
            gainOf(*share.body, *share.impulse),
            motionOf(*share.body) + solve(massMatrix(*share.body), *share.impulse)};
    return result;
}

EnergyBalance::Result EnergyBalance::balance(const ClothStep& step, const Cloth& cloth,
                                             std::vector<Share>& shares) {
    constexpr double kForget = 1.0;  // s
    constexpr double kLent = 0.3;    // of a small lift: what may come back of what was lost
    constexpr double kSlow = 0.5;    // m/s: motion of all of the cloth that nobody would miss
    constexpr double kTell = 10.0;   // times that energy
    const std::optional<double> energy = step.stepper.internal_energy(step.to.x);
    if (!energy || step.garment.has_goals() ||
        !(allSolidsKnown(step) || obstaclesStand(step.boundary))) {
        forget();
        Result result;
        result.unknown = !energy;
        return result;
    }
    if (!m_elastic || !step.continues) {
        m_elastic = cloth.mass_ratio * step.stepper.internal_energy(step.from.x).value_or(0.0);
        m_debt = 0.0;
    }
    double motion = motionAndHeight(step, cloth.masses, step.to) -
                    motionAndHeight(step, cloth.masses, step.from) - cloth.work;
    for (const Share& share : shares) {
        const double gain = gainOf(*share.body, *share.impulse);
        const double borne_before = borneBefore(share, step.length);
        const double raised = gain - std::clamp(gain, 0.0, borne_before) + share.lift;
        motion += raised;
        if (share.anchored) motion -= std::clamp(raised, 0.0, lostInFall(share, step.length));
    }
    const double stored = cloth.mass_ratio * *energy - *m_elastic;
    m_elastic = cloth.mass_ratio * *energy;
    const bool borne = std::any_of(step.near.begin(), step.near.end(),
                                   [](const NearSolid& solid) { return !solid.body; });
    const bool pressed = std::any_of(step.near.begin(), step.near.end(),
                                     [](const NearSolid& solid) { return solid.body; });
    const bool anchored = std::any_of(shares.begin(), shares.end(),
                                      [](const Share& share) { return share.anchored; });
    const double little = 0.5 * cloth.masses.sum() * kSlow * kSlow;
    // Bullet pushes bodies that lie in hanging cloth about all the time, and that is work.
    const bool piled = pressed && !borne && !anchored;
    const double made = motion + stored + m_debt, owed = std::max(0.0, made);
    // Contacts that push coarse cloth stretch it a little, which seldom becomes motion. It is paid
    // where it does: taken at once, it would be all of slow motion, and cloth creep as in honey.
    const double small = smallLift(step, cloth);
    const bool may_wait = shares.empty() && owed <= small;
    const double surplus = may_wait ? std::clamp(motion, 0.0, owed) : owed;
    m_debt = (owed - surplus) * std::exp(-step.length / kForget);
    // Of what cloth and bodies exchange as they swing, a part is in neither for a step. Taken
    // whenever it is back, it would be all of the motion where they turn round.
    if (anchored && made < 0.0)
        m_debt = std::max(made, -kLent * small) * std::exp(-step.length / kForget);
    Result result;
    if (!(surplus > (piled ? little : 0.0))) {
        if (piled) m_debt = surplus * std::exp(-step.length / kForget);
        return result;
    }
    double left = calmCloth(step, cloth, surplus);
    result.much = left > kTell * little;
    result.limited = left > 0.0;
    left = limitGains(shares, left);
    if (!cloth.floats) left = brake(shares, left);
    if (piled) left = stopPressing(shares, left);
    // Where nothing else bears a body, cloth that is held back alone would let it through.
    result.together = left > little && piled && cloth.bodies_wait;
    result.held = result.together || (left > little && borne);
    if (result.held) {
        const TakenWay taken = holdBack(step, cloth, left);
        left = taken.left;
        result.way = taken.part;
        m_elastic = cloth.mass_ratio * step.stepper.internal_energy(step.to.x).value_or(0.0);
    }
    if (!piled || cloth.bodies_wait) m_debt += left * std::exp(-step.length / kForget);
    return result;
}

}  // namespace cloth
