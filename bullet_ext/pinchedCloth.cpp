#include "bullet_ext/pinchedCloth.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace cloth {

namespace {

// Twice the distance that contacts keep, so that neither pushes cloth into the other.
constexpr double kRoom = 8e-3;  // m
// Cloth that lacks more than this when room has been made is caught.
constexpr double kCaught = 2e-3;    // m
constexpr double kReach = 0.1;      // m: solids farther than this and their motion are not near
constexpr double kMost = 0.5;       // m: no solid makes more room than this
constexpr double kOpposite = -0.3;  // cosine of surfaces between which cloth is pinched

/// Static solids never make room, kinematic ones for static ones, light ones for heavy ones.
double yieldOf(const NearSolid& solid) {
    if (solid.body) return 1.0 + static_cast<double>(solid.body->getInvMass());
    return solid.object->isKinematicObject() ? 0.5 : 0.0;
}

LimbSet usedBits(const Boundary& boundary) {
    LimbSet used = 0;
    for (const Obstacle& obstacle : boundary.obstacles)
        if (has_limbs(obstacle))
            for (const std::uint8_t limb : *obstacle.limbs) used |= LimbSet(1) << limb;
    return used;
}

}  // namespace

void PinchedCloth::makeRoom(const Garment& garment, const ClothState& from,
                            std::vector<NearSolid>& solids,
                            const std::vector<const btCollisionObject*>& owners,
                            Boundary& boundary) {
    const auto count = static_cast<size_t>(from.x.rows());
    m_keeper.assign(count, -1);
    m_pincher.assign(count, -1);
    m_ignored.assign(count, 0);
    m_shift.assign(solids.size(), {});
    m_bits.assign(solids.size(), 0);
    m_yield.clear();
    m_caught = 0;
    for (size_t s = 0; s < solids.size(); ++s) {
        m_yield.push_back(yieldOf(solids[s]));
        const auto last = m_shifts.find(solids[s].object);
        if (last != m_shifts.end()) m_shift[s].before = last->second;
        solids[s].shift(m_shift[s].before, Vec3::Zero());
    }
    m_shifts.clear();
    findPinches(garment, from.x, solids);
    separate();
    for (size_t s = 0; s < solids.size(); ++s) {
        solids[s].shift(Vec3::Zero(), m_shift[s].now);
        if (!m_shift[s].now.isZero(0.0)) m_shifts[solids[s].object] = m_shift[s].now;
    }
    for (size_t k = 0; k < owners.size(); ++k)
        for (size_t s = 0; s < solids.size(); ++s) {
            if (solids[s].object != owners[k]) continue;
            Obstacle& obstacle = boundary.obstacles[k];
            const Shift& shift = m_shift[s];
            if (shift.before.isZero(0.0) && shift.now.isZero(0.0)) continue;
            obstacle.pose0.pretranslate(shift.before);
            obstacle.pose1.pretranslate(shift.now);
            obstacle.x0.rowwise() += shift.before.transpose();
            obstacle.x1.rowwise() += shift.now.transpose();
        }
    markNodes(solids, owners, boundary);
}

void PinchedCloth::shift(std::vector<NearSolid>& solids) const {
    for (NearSolid& solid : solids) {
        const auto found = m_shifts.find(solid.object);
        if (found != m_shifts.end()) solid.shift(found->second, found->second);
    }
}

bool PinchedCloth::ignores(int node, size_t solid) const {
    const auto i = static_cast<size_t>(node);
    return i < m_ignored.size() && solid < m_bits.size() && (m_ignored[i] & m_bits[solid]) != 0;
}

void PinchedCloth::findPinches(const Garment& garment, const Points& x,
                               const std::vector<NearSolid>& solids) {
    m_pinches.clear();
    if (solids.size() < 2) return;
    m_moving.clear();
    for (const NearSolid& solid : solids) m_moving.push_back({solid.before(), solid.motion()});
    const std::vector<char>& pinned = garment.is_pinned();
    for (int i = 0; i < static_cast<int>(x.rows()); ++i)
        if (!pinned[static_cast<size_t>(i)]) testPoint(x.row(i), {i, i, i}, solids);
    for (const auto& [a, b] : garment.edges())
        testPoint(0.5 * (x.row(a) + x.row(b)), {a, b, b}, solids);
    const Faces& faces = garment.rest().faces;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
        testPoint((x.row(a) + x.row(b) + x.row(c)) / 3.0, {a, b, c}, solids);
    }
}

void PinchedCloth::testPoint(const Vec3& x, const std::array<int, 3>& nodes,
                             const std::vector<NearSolid>& solids) {
    m_near.clear();
    for (size_t s = 0; s < solids.size(); ++s) {
        const Vec3 place = m_moving[s].motion * x;
        const double reach = kReach + (place - x).norm();
        const std::optional<double> distance = m_moving[s].before.distance(x, reach);
        if (distance) m_near.push_back({s, *distance, reach, place});
    }
    for (const Near& pincher : m_near) {
        const double yield = m_yield[pincher.solid];
        if (yield == 0.0) continue;
        for (const Near& keeper : m_near) {
            const double kept = m_yield[keeper.solid];
            if (yield > kept || (yield == kept && pincher.solid > keeper.solid))
                testPair(x, nodes, solids[pincher.solid], keeper, pincher);
        }
    }
}

/// The planes are those of the surface points that are nearest at the start of the step, when the
/// point is outside of both.
void PinchedCloth::testPair(const Vec3& x, const std::array<int, 3>& nodes, const NearSolid& other,
                            const Near& keeper, const Near& pincher) {
    // The room is the sum of both distances and of what one solid moves towards the other.
    constexpr double kRounding = 1e-9;  // m
    const double least =
        keeper.distance + pincher.distance - (keeper.place - pincher.place).norm() - kRounding;
    if (least > kRoom) return;
    const Moving &kept = m_moving[keeper.solid], &pinching = m_moving[pincher.solid];
    const Vec3 out = kept.before.outward(x, keeper.reach);
    const Vec3 other_out = pinching.before.outward(x, pincher.reach);
    if (out.isZero(0.0) || other_out.isZero(0.0)) return;
    const Vec3 kept_point = kept.motion * Vec3(x - keeper.distance * out);
    const Vec3 other_point = pinching.motion * Vec3(x - pincher.distance * other_out);
    const Vec3 kept_normal = kept.motion.linear() * out;
    const Vec3 other_normal = pinching.motion.linear() * other_out;
    if (!(kept_normal.dot(other_normal) < kOpposite)) return;
    // Where the point would come to lie on what it keeps to: is the other one there?
    const Vec3& place = keeper.place;
    const Vec3 landing = place - (kept_normal.dot(place - kept_point) - 0.5 * kRoom) * kept_normal;
    if (!other.distance(landing, 0.5 * kRoom)) return;
    const double room = kept_normal.dot(place - kept_point) + other_normal.dot(place - other_point);
    if (room < kRoom)
        m_pinches.push_back({nodes, keeper.solid, pincher.solid, kept_normal, other_normal, room});
}

double PinchedCloth::roomOf(const Pinch& pinch) const {
    return pinch.room - m_shift[pinch.keeper].now.dot(pinch.keeper_out) -
           m_shift[pinch.pincher].now.dot(pinch.pincher_out);
}

/// Moves the solids apart, those that lack the most first.
void PinchedCloth::separate() {
    constexpr int kRounds = 20;
    for (int round = 0; round < kRounds; ++round) {
        bool done = true;
        for (size_t s = 0; s < m_shift.size(); ++s) {
            const Pinch* worst = nullptr;
            for (const Pinch& pinch : m_pinches)
                if (pinch.pincher == s && (!worst || roomOf(pinch) < roomOf(*worst)))
                    worst = &pinch;
            if (!worst || !(roomOf(*worst) < kRoom - 1e-6)) continue;
            done = false;
            Vec3& now = m_shift[s].now;
            now -= (kRoom - roomOf(*worst)) * worst->pincher_out;
            if (now.norm() > kMost) now *= kMost / now.norm();
        }
        if (done) return;
    }
}

void PinchedCloth::markNodes(const std::vector<NearSolid>& solids,
                             const std::vector<const btCollisionObject*>& owners,
                             Boundary& boundary) {
    LimbSet used = m_pinches.empty() ? 0 : usedBits(boundary);
    const auto bitOf = [&](size_t solid) {
        for (LimbSet bit = LimbSet(1) << 31; bit != 0 && m_bits[solid] == 0; bit >>= 1)
            if ((used & bit) == 0) m_bits[solid] = bit, used |= bit;
        return m_bits[solid];
    };
    for (const Pinch& pinch : m_pinches) {
        const bool caught = roomOf(pinch) < kRoom - kCaught;
        for (const int node : pinch.nodes) {
            const auto i = static_cast<size_t>(node);
            if (pinch.nodes[0] == pinch.nodes[2] || caught) {
                m_keeper[i] = static_cast<int>(pinch.keeper);
                m_pincher[i] = static_cast<int>(pinch.pincher);
            }
            if (caught) m_ignored[i] |= bitOf(pinch.pincher);
        }
    }
    m_caught = static_cast<int>(
        std::count_if(m_ignored.begin(), m_ignored.end(), [](LimbSet bits) { return bits != 0; }));
    if (m_caught == 0) return;
    boundary.ignored_limbs = m_ignored;
    for (size_t k = 0; k < owners.size(); ++k)
        for (size_t s = 0; s < solids.size(); ++s)
            if (solids[s].object == owners[k]) boundary.obstacles[k].solid = m_bits[s];
}

}  // namespace cloth
