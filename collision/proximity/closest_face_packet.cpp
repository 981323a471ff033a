#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "collision/proximity/closest_face_tree.h"
#include "collision/proximity/eight_boxes.h"
#include "data/core/triangle.h"

// Neighbouring points visit nearly the same nodes and faces, so they are searched for together: a
// node is tested against the sphere that holds the spheres of all of them, what passes against each
// of them, a face's distance is computed for all at once. What comes within rounding of the
// smallest distance is a candidate, and closest_on_triangle() decides between candidates, as for
// one point.

namespace cloth {
namespace {

constexpr int lanes = ClosestFaceTree::packet;
template <class Real>
using Lanes = std::array<Real, lanes>;
using EightDoubles = double __attribute__((vector_size(sizeof(Lanes<double>))));

// What the distance of a face (m) may be off by: in single precision that holds of small faces near
// the points that are not thin, height over longest edge; the others take double precision.
constexpr float distance_error = 1e-6f;
constexpr float near_centre = 0.25f;                                 // m
constexpr double small_face = 0.1, thin_face = 0.05, needle = 1e-4;  // m and without unit

/// A bound that is so far from the squared distance as two distances that are off.
float with_slack(float squared) {
    const float distance = std::sqrt(squared) + 2.0f * distance_error;
    return distance * distance;
}

/// A face, from the centre of the points.
struct FaceConstants {
    Vec3 a, ab, ac, bc, normal;  ///< normal: not of unit length
    double ab2, ac2, bc2, ab_ac, cross2, longest2;

    FaceConstants(const Vec3& corner_a, const Vec3& b, const Vec3& c)
        : a(corner_a), ab(b - a), ac(c - a), bc(c - b), normal(ab.cross(ac)) {
        ab2 = ab.squaredNorm(), ac2 = ac.squaredNorm(), bc2 = bc.squaredNorm();
        ab_ac = ab.dot(ac);
        cross2 = normal.squaredNorm();
        longest2 = std::max({ab2, ac2, bc2});
    }

    bool is_thicker_than(double share) const {
        return cross2 > share * share * longest2 * longest2;
    }
};

template <class Vector>
void take_smaller(Vector& a, const Vector& b) {
    a = a < b ? a : b;
}

/// Squared distances of the points to a face: to its plane above the face, else to its edges.
template <class Real, class Vector>
EightFloats face_distances(const FaceConstants& face, const Lanes<Real>& all_x,
                           const Lanes<Real>& all_y, const Lanes<Real>& all_z) {
    const Eigen::Matrix<Real, 3, 1> a = face.a.cast<Real>(), ab = face.ab.cast<Real>(),
                                    ac = face.ac.cast<Real>(), bc = face.bc.cast<Real>(),
                                    normal = face.normal.cast<Real>();
    const Real ab2 = Real(face.ab2), ac2 = Real(face.ac2), ab_ac = Real(face.ab_ac),
               cross2 = Real(face.cross2);
    const Eigen::Array<Real, 4, 1> inverse =
        Eigen::Array<Real, 4, 1>(ab2, ac2, Real(face.bc2), cross2).inverse();
    Vector x, y, z;
    std::memcpy(&x, all_x.data(), sizeof x);
    std::memcpy(&y, all_y.data(), sizeof y);
    std::memcpy(&z, all_z.data(), sizeof z);
    const Vector zero = {}, one = zero + Real(1);
    const Vector px = x - a[0], py = y - a[1], pz = z - a[2];
    const Vector qx = px - ab[0], qy = py - ab[1], qz = pz - ab[2];
    const Vector d1 = ab[0] * px + ab[1] * py + ab[2] * pz;
    const Vector d2 = ac[0] * px + ac[1] * py + ac[2] * pz;
    const Vector d3 = bc[0] * qx + bc[1] * qy + bc[2] * qz;
    Vector t1 = d1 * inverse[0], t2 = d2 * inverse[1], t3 = d3 * inverse[2];
    for (Vector* t : {&t1, &t2, &t3}) {
        *t = *t > zero ? *t : zero;
        *t = *t < one ? *t : one;
    }
    const Vector ux = px - t1 * ab[0], uy = py - t1 * ab[1], uz = pz - t1 * ab[2];
    const Vector vx = px - t2 * ac[0], vy = py - t2 * ac[1], vz = pz - t2 * ac[2];
    const Vector wx = qx - t3 * bc[0], wy = qy - t3 * bc[1], wz = qz - t3 * bc[2];
    Vector edges = ux * ux + uy * uy + uz * uz;
    take_smaller<Vector>(edges, vx * vx + vy * vy + vz * vz);
    take_smaller<Vector>(edges, wx * wx + wy * wy + wz * wz);
    const Vector height = normal[0] * px + normal[1] * py + normal[2] * pz;
    const Vector v = ac2 * d1 - ab_ac * d2, w = ab2 * d2 - ab_ac * d1;
    Vector inside = v;
    take_smaller<Vector>(inside, w);
    take_smaller<Vector>(inside, cross2 - v - w);
    const Vector result = inside < zero ? edges : height * height * inverse[3];
    return __builtin_convertvector(result, EightFloats);
}

}  // namespace

/// The points of a search, and what has been found for them.
struct ClosestFaceTree::Packet {
    struct Candidate {
        int face;
        float squared;
    };
    static constexpr int most_candidates = 16;

    const ClosestFaceTree& tree;
    const Query* queries;
    const int count;
    FaceHit* hits;
    Vec3 centre;                        ///< of the points
    alignas(64) Lanes<double> x, y, z;  ///< from the centre; unused lanes repeat a point
    alignas(32) Lanes<float> near_x, near_y, near_z;     ///< the same
    alignas(32) Lanes<float> local_x, local_y, local_z;  ///< from the tree's origin
    alignas(32) Lanes<float> bound;  ///< of squared distances; negative in unused lanes
    LimbSet ignored_by_all = ~LimbSet(0);
    Eigen::Vector3f local_centre;
    float reach = 0.0f;  ///< squared radius of the sphere around the spheres of all
    std::array<std::array<Candidate, most_candidates>, lanes> candidates;
    Lanes<int> candidate_count = {};

    Packet(const ClosestFaceTree& searched, const Query* of, int number, FaceHit* found)
        : tree(searched), queries(of), count(number), hits(found) {
        Vec3 low = queries[0].x, high = low;
        for (int k = 1; k < count; ++k) {
            low = low.cwiseMin(queries[k].x);
            high = high.cwiseMax(queries[k].x);
        }
        centre = 0.5 * (low + high);
        local_centre = (centre - tree.m_origin).cast<float>();
        for (int k = 0; k < lanes; ++k) take(k, queries[k < count ? k : 0], k < count);
        update_reach();
    }

    void take(int lane, const Query& query, bool is_used) {
        const auto k = static_cast<size_t>(lane);
        const Vec3 offset = query.x - centre;
        x[k] = offset[0], y[k] = offset[1], z[k] = offset[2];
        const Eigen::Vector3f near = offset.cast<float>();
        near_x[k] = near[0], near_y[k] = near[1], near_z[k] = near[2];
        const Eigen::Vector3f local = (query.x - tree.m_origin).cast<float>();
        local_x[k] = local[0], local_y[k] = local[1], local_z[k] = local[2];
        bound[k] = -1.0f;
        if (!is_used) return;
        ignored_by_all &= query.ignored;
        FaceHit& hit = hits[lane] = {};
        hit.squared = query.radius * query.radius;
        if (query.hint >= 0 && (tree.limb(query.hint) & query.ignored) == 0)
            tree.try_face(query.x, query.hint, hit);
        bound[k] = widened(with_slack(static_cast<float>(hit.squared)));
    }

    /// Whatever is nearer to a point than its bound is nearer to the centre than this.
    void update_reach() {
        float radius = 0.0f;
        for (size_t k = 0; k < size_t(count); ++k) {
            const Eigen::Vector3f offset(near_x[k], near_y[k], near_z[k]);
            radius = std::max(radius, std::sqrt(bound[k]) + offset.norm());
        }
        reach = radius * radius * 1.0001f + std::numeric_limits<float>::min();
    }

    /// Bit k: the box of child k is within reach, with limbs that not all ignore. A slot without a
    /// child has none: for points so far away that they are infinite here, its box is no test.
    unsigned children_in_reach(const Node& node, EightFloats& squared) const {
        squared = box_distances(node.low, node.high, local_centre);
        const EightSets limbs = load_eight<EightSets>(node.limbs) & ~ignored_by_all;
        return bits((squared <= reach) & (limbs != 0));
    }

    /// Whether the box of a child is within the bound of any point.
    bool any_within(const Node& node, int slot) const {
        EightFloats sum = EightFloats{} - load_eight(bound.data());
        const float* const points[3] = {local_x.data(), local_y.data(), local_z.data()};
        for (int k = 0; k < 3; ++k) {
            const EightFloats at = load_eight(points[k]);
            const EightFloats below = node.low[k][slot] - at, above = at - node.high[k][slot];
            const EightFloats larger = below > above ? below : above;
            const EightFloats outside = larger > 0.0f ? larger : EightFloats{};
            sum += outside * outside;
        }
        return bits(sum <= 0.0f) != 0;
    }

    void try_face(int face) {
        const auto corner = [&](int k) -> Vec3 {
            return tree.m_vertices.row((*tree.m_faces)(face, k)).transpose() - centre;
        };
        const FaceConstants constants(corner(0), corner(1), corner(2));
        EightFloats squared;
        if (constants.is_thicker_than(thin_face) && constants.longest2 < small_face * small_face &&
            reach < near_centre * near_centre)
            squared = face_distances<float, EightFloats>(constants, near_x, near_y, near_z);
        else if (constants.is_thicker_than(needle))
            squared = face_distances<double, EightDoubles>(constants, x, y, z);
        else
            return try_exactly(face);
        const LimbSet limb = tree.limb(face);
        bool improved = false;
        for (unsigned left = bits(squared <= load_eight(bound.data())); left != 0;
             left &= left - 1) {
            const int k = __builtin_ctz(left);
            const auto lane = static_cast<size_t>(k);
            if ((limb & queries[k].ignored) != 0 || face == queries[k].hint) continue;
            if (candidate_count[lane] == most_candidates) decide(k);
            candidates[lane][static_cast<size_t>(candidate_count[lane]++)] = {face, squared[k]};
            const float enough = widened(with_slack(squared[k]));
            if (!(enough < bound[lane])) continue;
            bound[lane] = enough;
            improved = true;
        }
        if (improved) update_reach();
    }

    void try_exactly(int face) {
        for (int k = 0; k < count; ++k)
            if ((tree.limb(face) & queries[k].ignored) == 0)
                tree.try_face(queries[k].x, face, hits[k]);
    }

    /// Tries the candidates that are left.
    void decide(int k) {
        const auto lane = static_cast<size_t>(k);
        for (int at = 0; at < candidate_count[lane]; ++at) {
            const Candidate& candidate = candidates[lane][static_cast<size_t>(at)];
            if (candidate.squared <= bound[lane])
                tree.try_face(queries[k].x, candidate.face, hits[k]);
        }
        candidate_count[lane] = 0;
    }
};

void ClosestFaceTree::closest(const Query* queries, int count, Stack& stack, FaceHit* hits) const {
    if (count == 1) {
        *hits = closest(queries->x, queries->radius, queries->hint, stack, queries->ignored);
        return;
    }
    Packet together(*this, queries, count, hits);
    if (m_nodes.empty()) return;
    if (stack.size() < m_stack_size) stack.resize(m_stack_size);
    Entry* end = stack.data();
    *end++ = {0, 0.0f};
    while (end != stack.data()) {
        const Entry entry = *--end;
        if (entry.squared > together.reach) continue;
        const Node& node = m_nodes[static_cast<size_t>(entry.child)];
        EightFloats squared;
        Entry* const first = end;
        for (unsigned left = together.children_in_reach(node, squared); left != 0;
             left &= left - 1) {
            const int slot = __builtin_ctz(left);
            if (!together.any_within(node, slot)) continue;
            if (node.child[slot] < 0)
                together.try_face(~node.child[slot]);
            else
                *end++ = {node.child[slot], squared[slot]};
        }
        nearest_last(first, end);
    }
    for (int k = 0; k < count; ++k) together.decide(k);
}

}  // namespace cloth
