#include "bullet_ext/clothContacts.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "bullet_ext/bodyFollower.h"
#include "bullet_ext/softBodyGarment.h"
#include "bullet_ext/softBodyStep.h"
#include "bullet_ext/surplusEnergy.h"
#include "collision/response/resolve.h"

namespace cloth {

namespace {

/// That nodes keep from obstacles when they are pushed (m).
constexpr double kObstacleDistance = 5e-4;

struct Box {
    Vec3 low, high;

    bool meets(const Box& other) const {
        return (low.array() <= other.high.array()).all() &&
               (other.low.array() <= high.array()).all();
    }
};

/// Where the nodes may come in a world step of h seconds.
Box boxOf(const btSoftBody& body, double h) {
    constexpr double kMargin = 0.05;  // m: cloth that is near is near for more than one step
    Points ends(2 * body.m_nodes.size(), 3);
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const Vec3 x = toVec3(body.m_nodes[i].m_x);
        ends.row(2 * i) = x;
        ends.row(2 * i + 1) = x + 2.0 * h * toVec3(body.m_nodes[i].m_v);
    }
    const Vec3 margin = Vec3::Constant(kMargin);
    return {ends.colwise().minCoeff().transpose() - margin,
            ends.colwise().maxCoeff().transpose() + margin};
}

/// The pieces as one mesh, each at the place where its body is, so that neighbours in space are
/// neighbours in the hierarchy of faces.
Garment merge(const std::vector<ClothContacts::Member>& group, const std::vector<char>& moves) {
    Eigen::Index vertices = 0, faces = 0;
    for (const auto& member : group) {
        vertices += member.step->garment().vertex_count();
        faces += member.step->garment().face_count();
    }
    TriMesh all{Points(vertices, 3), Faces(faces, 3)};
    std::vector<int> pins;
    Eigen::Index vertex = 0, face = 0;
    for (size_t k = 0; k < group.size(); ++k) {
        const Garment& garment = group[k].step->garment();
        const Points& rest = garment.rest().vertices;
        const Eigen::RowVector3d way =
            group[k].step->shown().colwise().mean() - rest.colwise().mean();
        all.vertices.middleRows(vertex, rest.rows()) = rest.rowwise() + way;
        all.faces.middleRows(face, garment.face_count()) =
            garment.rest().faces.array() + static_cast<int>(vertex);
        for (Eigen::Index i = 0; i < rest.rows(); ++i)
            if (!moves[k] || garment.is_pinned()[static_cast<size_t>(i)])
                pins.push_back(static_cast<int>(vertex + i));
        vertex += rest.rows();
        face += garment.face_count();
    }
    return Garment("cloth bodies that meet", std::move(all), Fabric::soft_cotton(), pins);
}

/// The obstacles around all members at the end of the world step; looked for when first asked.
class Obstacles : public LayerContacts::Outside {
 public:
    Obstacles(const std::vector<ClothContacts::Member>& group,
              const std::vector<Eigen::Index>& first, const Points& x0,
              std::vector<Proximity>& proximity, BulletObstacles& obstacles, double h)
        : m_group(group),
          m_first(first),
          m_x0(x0),
          m_proximity(proximity),
          m_obstacles(obstacles),
          m_h(h) {}

    double push_out(const std::vector<int>& rows, Points& x) override {
        if (m_parts.empty()) look(x);
        double deepest = 0.0;
        auto row = rows.begin();
        for (size_t k = 0; k < m_parts.size(); ++k) {
            Part& part = m_parts[k];
            part.rows.clear();
            for (; row != rows.end() && *row < m_first[k + 1]; ++row) {
                const auto i = static_cast<int>(*row - m_first[k]);
                if (!pinned(k)[static_cast<size_t>(i)]) part.rows.push_back(i);
            }
            deepest = std::max(deepest, pushOut(k, x));
        }
        return deepest;
    }

    const SurfaceContacts& contacts() const override { return m_all; }

    /// Whether none was found.
    bool areNone() const {
        return std::all_of(m_parts.begin(), m_parts.end(),
                           [](const Part& part) { return part.boundary.obstacles.empty(); });
    }

    /// Deepest vertex of a member that is not pinned (m); none where nothing was pushed.
    double deepest(size_t member, const Points& x) {
        if (m_parts.empty()) return 0.0;
        Part& part = m_parts[member];
        if (part.boundary.obstacles.empty()) return 0.0;
        m_proximity[member].query(piece(member, x), part.boundary, part.contacts, StepEnd::end,
                                  limits(member));
        double depth = 0.0;
        for (Eigen::Index i = 0; i < part.contacts.distance.size(); ++i)
            if (!pinned(member)[static_cast<size_t>(i)])
                depth = std::max(depth, -part.contacts.distance[i]);
        return depth;
    }

 private:
    struct Part {
        Boundary boundary;
        SurfaceContacts contacts;
        std::vector<int> rows;
    };

    const std::vector<char>& pinned(size_t k) const {
        return m_group[k].step->garment().is_pinned();
    }
    Points piece(size_t k, const Points& x) const {
        return x.middleRows(m_first[k], m_first[k + 1] - m_first[k]);
    }
    QueryLimits limits(size_t k) const {
        const auto& ignored = m_group[k].step->stepper().ignored_limbs();
        QueryLimits result;
        if (ignored.size() == pinned(k).size()) result.ignored = &ignored;
        return result;
    }

    void look(const Points& x) {
        m_parts.resize(m_group.size());
        bool any = false;
        for (size_t k = 0; k < m_parts.size(); ++k) {
            Part& part = m_parts[k];
            const Points before = piece(k, m_x0), now = piece(k, x);
            part.boundary = obstaclesAround(*m_group[k].body, {&before, &now}, m_obstacles, m_h);
            any = any || !part.boundary.obstacles.empty();
            m_proximity[k].query(now, part.boundary, part.contacts, StepEnd::end, limits(k));
        }
        if (any) resize(x.rows());
        for (size_t k = 0; any && k < m_parts.size(); ++k) publish(k);
    }

    void resize(Eigen::Index count) {
        m_all.obstacle.assign(static_cast<size_t>(count), -1);
        m_all.point1.setZero(count, 3);
        m_all.normal1.setZero(count, 3);
        m_all.distance.setConstant(count, std::numeric_limits<double>::infinity());
    }

    /// Moves rows of a part out, and brings their contacts up to date.
    double pushOut(size_t k, Points& x) {
        Part& part = m_parts[k];
        if (part.rows.empty() || part.boundary.obstacles.empty()) return 0.0;
        constexpr int kIterations = 3;
        Points now = piece(k, x);
        m_proximity[k].query_rows(now, part.rows, part.boundary, part.contacts, StepEnd::end,
                                  limits(k));
        double deepest = 0.0;
        for (const int i : part.rows) deepest = std::max(deepest, -part.contacts.distance[i]);
        push_out_rows(m_proximity[k], part.boundary, kObstacleDistance, kIterations, part.rows, now,
                      part.contacts, nullptr, limits(k));
        x.middleRows(m_first[k], now.rows()) = now;
        publish(k);
        return deepest;
    }

    void publish(size_t k) {
        const SurfaceContacts& from = m_parts[k].contacts;
        if (from.obstacle.empty()) return;
        const Eigen::Index first = m_first[k], count = m_first[k + 1] - first;
        std::copy(from.obstacle.begin(), from.obstacle.end(), m_all.obstacle.begin() + first);
        m_all.point1.middleRows(first, count) = from.point1;
        m_all.normal1.middleRows(first, count) = from.normal1;
        m_all.distance.segment(first, count) = from.distance;
    }

    const std::vector<ClothContacts::Member>& m_group;
    const std::vector<Eigen::Index>& m_first;
    const Points& m_x0;
    std::vector<Proximity>& m_proximity;
    BulletObstacles& m_obstacles;
    double m_h;
    std::vector<Part> m_parts;
    SurfaceContacts m_all;
};

/// Energy of all that moves (J); none where a stepper does not know that of its fabric.
std::optional<double> energyOf(const std::vector<ClothContacts::Member>& group,
                               const std::vector<Eigen::Index>& first, const VectorX& masses,
                               const Points& x, const Points& v) {
    double energy = 0.5 * masses.dot(v.rowwise().squaredNorm());
    for (size_t k = 0; k < group.size(); ++k) {
        const Eigen::Index count = first[k + 1] - first[k];
        const Points piece = x.middleRows(first[k], count);
        const std::optional<double> elastic = group[k].step->stepper().internal_energy(piece);
        if (!elastic) return std::nullopt;
        energy += massRatio(*group[k].body, group[k].step->garment()) * *elastic -
                  masses.segment(first[k], count)
                      .dot(piece * toVec3(group[k].body->m_worldInfo->m_gravity));
    }
    return energy;
}

}  // namespace

bool askForContact(const btSoftBody& a, const btSoftBody& b) {
    constexpr int kSoftContact = btSoftBody::fCollision::VF_SS | btSoftBody::fCollision::CL_SS;
    if ((a.m_cfg.collisions & b.m_cfg.collisions & kSoftContact) == 0) return false;
    const btBroadphaseProxy *first = a.getBroadphaseHandle(), *second = b.getBroadphaseHandle();
    if (!first || !second) return false;
    return (first->m_collisionFilterGroup & second->m_collisionFilterMask) != 0 &&
           (second->m_collisionFilterGroup & first->m_collisionFilterMask) != 0 &&
           a.checkCollideWith(&b) && b.checkCollideWith(&a);
}

bool ClothContacts::Part::operator<(const Part& other) const {
    return std::tie(build, moves, mass_ratio, friction) <
           std::tie(other.build, other.moves, other.mass_ratio, other.friction);
}

void ClothContacts::beginStep(double h) {
    m_h = h;
    ++m_step;
    forgetUnused();
}

void ClothContacts::forgetUnused() {
    constexpr long kRemember = 120;  // world steps
    for (auto it = m_merged.begin(); it != m_merged.end();)
        it = it->second.used + kRemember < m_step ? m_merged.erase(it) : std::next(it);
}

std::vector<std::vector<size_t>> ClothContacts::groups(
    const std::vector<const btSoftBody*>& bodies) const {
    std::vector<Box> boxes;
    boxes.reserve(bodies.size());
    for (const btSoftBody* body : bodies) boxes.push_back(boxOf(*body, m_h));
    std::vector<size_t> root(bodies.size());  // of each group the first body
    std::iota(root.begin(), root.end(), size_t{0});
    for (size_t a = 0; a < bodies.size(); ++a)
        for (size_t b = a + 1; b < bodies.size(); ++b) {
            if (root[a] == root[b] || !boxes[a].meets(boxes[b])) continue;
            if (!askForContact(*bodies[a], *bodies[b])) continue;
            const auto [first, second] = std::minmax(root[a], root[b]);
            std::replace(root.begin(), root.end(), size_t{second}, size_t{first});
        }
    std::map<size_t, std::vector<size_t>> members;
    for (size_t k = 0; k < root.size(); ++k) members[root[k]].push_back(k);
    std::vector<std::vector<size_t>> result;
    for (auto& [first, group] : members)
        if (group.size() > 1) result.push_back(std::move(group));
    return result;
}

std::vector<ClothContacts::Part> ClothContacts::partsOf(const std::vector<Member>& group) const {
    std::vector<Part> parts;
    for (const Member& member : group)
        parts.push_back({member.build, member.step->endsWithWorldStep(),
                         massRatio(*member.body, member.step->garment()),
                         usableFriction(member.body->m_cfg.kDF)});
    return parts;
}

void ClothContacts::expect(const std::vector<Member>& group) {
    std::vector<Part> parts = partsOf(group);
    for (Part& part : parts) part.moves = true;
    const auto it = m_merged.find(parts);
    if (it == m_merged.end() || it->second.used + 1 != m_step || !(it->second.h > 0.0)) return;
    Merged& merged = it->second;
    const Points& forecast = merged.contacts->forecast(m_h / merged.h);
    for (size_t k = 0; k < group.size(); ++k)
        group[k].step->expectContact(
            forecast.middleRows(merged.first[k], merged.first[k + 1] - merged.first[k]));
    merged.expected = m_step;
}

ClothContacts::Merged& ClothContacts::mergedOf(const std::vector<Member>& group) {
    const std::vector<Part> parts = partsOf(group);
    Merged& merged = m_merged[parts];
    merged.used = m_step;
    if (merged.contacts) return merged;
    std::vector<char> moves;
    std::vector<double> friction;
    std::vector<int> part;
    merged.first = {0};
    for (size_t k = 0; k < group.size(); ++k) {
        const Eigen::Index count = group[k].step->garment().vertex_count();
        moves.push_back(parts[k].moves);
        friction.push_back(parts[k].friction);
        part.insert(part.end(), static_cast<size_t>(count), static_cast<int>(k));
        merged.first.push_back(merged.first.back() + count);
    }
    VectorX masses(merged.first.back());
    for (size_t k = 0; k < group.size(); ++k) {
        const double ratio = parts[k].mass_ratio > 0.0 ? parts[k].mass_ratio : 1.0;  // all pinned
        masses.segment(merged.first[k], merged.first[k + 1] - merged.first[k]) =
            ratio * group[k].step->garment().masses();
    }
    merged.proximity.resize(group.size());
    const Garment all = merge(group, moves);
    merged.masses = masses;
    for (const int pin : all.pins()) merged.masses[pin] = 0.0;
    LayerContactSettings settings;
    settings.thickness = m_thickness;
    merged.contacts = std::make_unique<LayerContacts>(all, std::move(part), masses,
                                                      std::move(friction), settings);
    return merged;
}

/// Contact makes no energy; nor do steps that nothing works on. What came from nowhere is taken
/// from motion, now or later. Where the fabric took up much more than that, the cloth does not go
/// all the way; held back for less, it would hang in the air.
/// @param x1, v1  end of the members' own steps
/// @param in_air  no obstacle was found
void ClothContacts::balance(const std::vector<Member>& group, const Points& x1, const Points& v1,
                            bool in_air, Merged& merged) const {
    constexpr double kForget = 1.0;  // s
    constexpr double kLift = 0.013;  // m: what lifts all of the cloth by so much is little
    const auto energy = [&](const Points& x, const Points& v) {
        return energyOf(group, merged.first, merged.masses, x, v);
    };
    const std::optional<double> start = energy(merged.x0, merged.v0), alone = energy(x1, v1),
                                now = energy(merged.x, merged.v);
    if (!start || !alone || !now) return;
    const bool end_together = std::all_of(group.begin(), group.end(), [](const Member& member) {
        return member.step->endsWithWorldStep();
    });
    const bool untouched =
        end_together && std::none_of(group.begin(), group.end(), [](const Member& member) {
            return member.step->isWorkedOn();
        });
    double most = *alone;
    if (!end_together) most = std::max(*start, *alone);
    if (untouched) most = *start;
    const bool floats = merged.masses.minCoeff() > 0.0;
    merged.debt = takeFromMotion(*now - most + merged.debt, merged.masses, floats, merged.v);
    const double little =
        kLift * merged.masses.sum() * toVec3(group.front().body->m_worldInfo->m_gravity).norm();
    // What floats in the air goes on as its momentum says.
    if (untouched && !(floats && in_air) && merged.debt > little) {
        const auto at = [&](const Points& x) { return *energy(x, merged.v); };
        merged.debt =
            takeFromWay(merged.debt, {0.75, 0.5, 0.25, 0.125, 0.0}, at, merged.x0, merged.x).left;
    }
    merged.debt *= std::exp(-m_h / kForget);
}

ClothContacts::Report ClothContacts::resolve(const std::vector<Member>& group,
                                             BulletObstacles& obstacles) {
    Merged& merged = mergedOf(group);
    if (merged.expected != m_step) merged.contacts->forget_forecast();
    merged.h = m_h;
    const Eigen::Index all = merged.first.back();
    for (Points* points : {&merged.x0, &merged.v0, &merged.x, &merged.v}) points->resize(all, 3);
    for (size_t k = 0; k < group.size(); ++k) {
        const auto put = [&](Points& points, const Points& piece) {
            points.middleRows(merged.first[k], piece.rows()) = piece;
        };
        const SoftBodyStep& step = *group[k].step;
        const ClothState end = step.endOfWorldStep();
        put(merged.x0, step.shown());
        put(merged.v0, step.shownVelocities());
        put(merged.x, end.x);
        put(merged.v, end.v);
    }
    const Points x1 = merged.x, v1 = merged.v;
    Obstacles outside(group, merged.first, merged.x0, merged.proximity, obstacles, m_h);
    const LayerContacts::Report found =
        merged.contacts->resolve(merged.x0, kObstacleDistance, &outside, merged.x, merged.v);
    const Report report{found.pairs + found.crossings, found.left};
    // A contact that was expected has pushed, too, if it did not come.
    if (merged.expected != m_step && merged.x == x1 && merged.v == v1) return report;
    balance(group, x1, v1, outside.areNone(), merged);
    for (size_t k = 0; k < group.size(); ++k) {
        if (!group[k].step->endsWithWorldStep()) continue;
        const Eigen::Index first = merged.first[k], count = merged.first[k + 1] - first;
        group[k].step->takeContact(merged.x.middleRows(first, count),
                                   merged.v.middleRows(first, count), outside.deepest(k, merged.x));
    }
    return report;
}

}  // namespace cloth
