#include "collision/proximity/closest_face_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "collision/geometry/fcl_hierarchy.h"
#include "data/core/triangle.h"

namespace cloth {

static constexpr float infinity = std::numeric_limits<float>::infinity();

ClosestFaceTree::ClosestFaceTree(const Points& vertices, const Faces& faces, double radius,
                                 const std::vector<std::uint8_t>* limbs)
    : m_faces(&faces), m_radius(radius), m_vertices(vertices) {
    if (limbs && are_limbs_of(faces, *limbs)) m_limbs = *limbs;
    build_nodes();
    mark_limbs();
    m_local.resize(static_cast<size_t>(vertices.rows()));
    localize();
    fit_leaves();
    fit_inner_nodes();
}

/// Up to `width` nodes of the binary tree that together replace the children of `root`: the one
/// with the most faces is opened until there is no room or nothing to open.
static std::vector<int> wide_children(const std::vector<BinaryNode>& binary, int root) {
    std::vector<int> children{root};
    while (children.size() < ClosestFaceTree::width) {
        const auto largest = std::max_element(children.begin(), children.end(), [&](int a, int b) {
            return binary[static_cast<size_t>(a)].face_count <
                   binary[static_cast<size_t>(b)].face_count;
        });
        const BinaryNode& opened = binary[static_cast<size_t>(*largest)];
        if (opened.left < 0) break;
        *largest = opened.left;
        children.push_back(opened.right);
    }
    return children;
}

void ClosestFaceTree::build_nodes() {
    const std::vector<BinaryNode> binary = build_fcl_hierarchy(m_vertices, *m_faces);
    if (binary.empty()) return;
    std::vector<int> roots{0};  // the binary node that each wide node replaces
    std::vector<size_t> depths{1};
    for (size_t i = 0; i < roots.size(); ++i) {
        Node node;
        for (int k = 0; k < 3; ++k) {
            node.low[k].setConstant(infinity);
            node.high[k].setConstant(-infinity);
        }
        std::fill_n(node.child, width, std::numeric_limits<std::int32_t>::min());
        int slot = 0;
        for (const int child : wide_children(binary, roots[i])) {
            const BinaryNode& source = binary[static_cast<size_t>(child)];
            node.child[slot++] = source.left < 0 ? ~source.face : static_cast<int>(roots.size());
            if (source.left < 0) continue;
            roots.push_back(child);
            depths.push_back(depths[i] + 1);
        }
        m_nodes.push_back(node);
    }
    m_stack_size = width * depths.back();  // breadth first: the last node is one of the deepest
}

void ClosestFaceTree::mark_limbs() {
    for (size_t i = m_nodes.size(); i-- > 0;) {
        Node& node = m_nodes[i];
        for (int slot = 0; slot < width; ++slot) {
            const std::int32_t child = node.child[slot];
            node.limbs[slot] = 0;
            if (child >= 0) {
                for (const LimbSet limbs : m_nodes[static_cast<size_t>(child)].limbs)
                    node.limbs[slot] |= limbs;
            } else if (~child < m_faces->rows()) {
                node.limbs[slot] = limb(~child);
            }
        }
    }
}

void ClosestFaceTree::refit(const Points& vertices) {
    const size_t bytes = static_cast<size_t>(vertices.size()) * sizeof(double);
    if (std::memcmp(vertices.data(), m_vertices.data(), bytes) == 0) return;
    std::memcpy(m_vertices.data(), vertices.data(), bytes);
    localize();
    fit_leaves();
    fit_inner_nodes();
}

/// Single-precision vertices relative to the centre: far from the world's origin the boxes stay
/// tight. Coordinates of 2^-24 relative precision are off by less than the padding.
void ClosestFaceTree::localize() {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (Eigen::Index i = 0; i < m_vertices.rows(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double x = m_vertices(i, k);
            if (!std::isfinite(x)) continue;
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
    m_origin = 0.5 * (low + high);
    if (!m_origin.allFinite()) m_origin.setZero();
    const double extent = (high - low).norm() + m_radius;
    m_padding = std::isfinite(extent) ? static_cast<float>(extent * 0x1p-21) : infinity;

    for (Eigen::Index i = 0; i < m_vertices.rows(); ++i) {
        const Vec3 x = m_vertices.row(i).transpose() - m_origin;
        m_local[static_cast<size_t>(i)] << x.cast<float>().array(), 0.0f;
    }
}

void ClosestFaceTree::fit_leaves() {
    for (Node& node : m_nodes)
        for (int slot = 0; slot < width; ++slot) {
            const int face = ~node.child[slot];
            if (face < 0 || face >= m_faces->rows()) continue;
            const Vec4f& a = m_local[static_cast<size_t>((*m_faces)(face, 0))];
            const Vec4f& b = m_local[static_cast<size_t>((*m_faces)(face, 1))];
            const Vec4f& c = m_local[static_cast<size_t>((*m_faces)(face, 2))];
            const bool finite = (a + b + c).isFinite().all();
            const Vec4f low = a.min(b).min(c) - m_padding, high = a.max(b).max(c) + m_padding;
            for (int k = 0; k < 3; ++k) {
                node.low[k][slot] = finite ? low[k] : infinity;
                node.high[k][slot] = finite ? high[k] : -infinity;
            }
        }
}

/// Children come after their parents, so one pass from the back is bottom-up.
void ClosestFaceTree::fit_inner_nodes() {
    for (size_t i = m_nodes.size(); i-- > 0;) {
        Node& node = m_nodes[i];
        for (int slot = 0; slot < width; ++slot) {
            if (node.child[slot] < 0) continue;
            const Node& child = m_nodes[static_cast<size_t>(node.child[slot])];
            for (int k = 0; k < 3; ++k) {
                node.low[k][slot] = child.low[k].minCoeff();
                node.high[k][slot] = child.high[k].maxCoeff();
            }
        }
    }
}

void ClosestFaceTree::try_face(const Vec3& q, int face, FaceHit& best) const {
    const Vec3 a = m_vertices.row((*m_faces)(face, 0));
    const Vec3 b = m_vertices.row((*m_faces)(face, 1));
    const Vec3 c = m_vertices.row((*m_faces)(face, 2));
    if (!has_area(a, b, c)) return;
    const TriangleHit hit = closest_on_triangle(q, a, b, c);
    const bool is_tie = hit.squared == best.squared && (best.face < 0 || face < best.face);
    if (hit.squared < best.squared || is_tie) best = {face, hit.barycentric, hit.squared};
}

/// Squared distances of a point to the eight boxes of a node.
ClosestFaceTree::Eight ClosestFaceTree::box_distances(const Node& node, const Eigen::Vector3f& q) {
    Eight sum = Eight::Zero();
    for (int k = 0; k < 3; ++k)
        sum += (node.low[k] - q[k]).max(q[k] - node.high[k]).max(0.0f).square();
    return sum;
}

void ClosestFaceTree::nearest_last(Entry* first, Entry* end) {
    for (Entry* entry = first + 1; entry < end; ++entry) {  // insertion sort: one to three entries
        const Entry moved = *entry;
        Entry* place = entry;
        for (; place > first && place[-1].squared < moved.squared; --place) *place = place[-1];
        *place = moved;
    }
}

/// Appends the children within the bound to the stack, the nearest last, and returns its new end.
ClosestFaceTree::Entry* ClosestFaceTree::push_children(const Node& node, const Eigen::Vector3f& q,
                                                       float bound, LimbSet ignored, Entry* end) {
    const Eight squared = box_distances(node, q);
    Entry* const first = end;
    for (int slot = 0; slot < width; ++slot) {  // no branch: which ones pass is unpredictable
        *end = {node.child[slot], squared[slot]};
        end += squared[slot] <= bound && (node.limbs[slot] & ~ignored) != 0;
    }
    nearest_last(first, end);
    return end;
}

FaceHit ClosestFaceTree::closest(const Vec3& q, double radius, int hint, Stack& stack,
                                 LimbSet ignored) const {
    FaceHit best;
    best.squared = radius * radius;
    if (m_nodes.empty()) return best;
    if (hint >= 0 && (limb(hint) & ignored) != 0) hint = -1;
    if (hint >= 0) try_face(q, hint, best);
    const Eigen::Vector3f local = (q - m_origin).cast<float>();
    float bound = widened(best.squared);

    if (stack.size() < m_stack_size) stack.resize(m_stack_size);
    Entry* end = push_children(m_nodes[0], local, bound, ignored, stack.data());
    while (end != stack.data()) {
        const Entry entry = *--end;
        if (entry.squared > bound) continue;
        if (entry.child >= 0) {
            end = push_children(m_nodes[static_cast<size_t>(entry.child)], local, bound, ignored,
                                end);
        } else if (~entry.child != hint) {
            try_face(q, ~entry.child, best);
            bound = widened(best.squared);
        }
    }
    return best;
}

/// Slab test of a ray with the eight boxes of a node: where it enters them, infinity: it does not.
ClosestFaceTree::Eight ClosestFaceTree::box_entries(const Node& node, const Eigen::Vector3f& q,
                                                    const Eigen::Vector3f& inverse, float length) {
    Eight enter = Eight::Zero(), leave = Eight::Constant(length);
    for (int k = 0; k < 3; ++k) {
        const Eight low = (node.low[k] - q[k]) * inverse[k];
        const Eight high = (node.high[k] - q[k]) * inverse[k];
        enter = enter.max(low.min(high));
        leave = leave.min(low.max(high));
    }
    return (enter <= leave).select(enter, infinity);
}

std::optional<RayHit> ClosestFaceTree::first_hit(const Vec3& q, const Vec3& direction,
                                                 double length, Stack& stack,
                                                 LimbSet ignored) const {
    if (m_nodes.empty()) return std::nullopt;
    const Eigen::Vector3f local = (q - m_origin).cast<float>();
    Eigen::Vector3f inverse;
    for (int k = 0; k < 3; ++k) {
        const double d = direction[k];
        inverse[k] = static_cast<float>(1.0 / (std::abs(d) < 1e-12 ? std::copysign(1e-12, d) : d));
    }
    if (stack.size() < m_stack_size) stack.resize(m_stack_size);
    int face = -1;
    double nearest = length;
    stack[0] = {0, 0.0f};
    Entry* end = stack.data() + 1;
    while (end != stack.data()) {
        const Entry entry = *--end;
        if (entry.squared > nearest) continue;
        if (entry.child < 0) {
            const double at = ray_distance(q, direction, ~entry.child);
            if (at < nearest || (at == nearest && ~entry.child < face))
                nearest = at, face = ~entry.child;
            continue;
        }
        const Node& node = m_nodes[static_cast<size_t>(entry.child)];
        const Eight enter =
            box_entries(node, local, inverse, static_cast<float>(nearest) * 1.00001f);
        for (int slot = 0; slot < width; ++slot)
            if (enter[slot] < infinity && (node.limbs[slot] & ~ignored) != 0)
                *end++ = {node.child[slot], enter[slot] * 0.99999f};
    }
    if (face < 0) return std::nullopt;
    return RayHit{face, nearest};
}

/// Where the ray meets a face; infinity: it does not.
double ClosestFaceTree::ray_distance(const Vec3& q, const Vec3& direction, int face) const {
    const auto hit =
        meet_line(q, direction, m_vertices.row((*m_faces)(face, 0)),
                  m_vertices.row((*m_faces)(face, 1)), m_vertices.row((*m_faces)(face, 2)));
    return hit && hit->is_inside() && hit->at >= 0.0 ? hit->at
                                                     : std::numeric_limits<double>::infinity();
}

}  // namespace cloth
