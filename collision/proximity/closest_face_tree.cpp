#include "collision/proximity/closest_face_tree.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "collision/geometry/fcl_hierarchy.h"
#include "collision/proximity/eight_boxes.h"
#include "data/core/triangle.h"

namespace cloth {

static constexpr float infinity = std::numeric_limits<float>::infinity();
static constexpr size_t middle_depth = 3;  // of up to 64 nodes: the trees below keep threads busy
static constexpr Eigen::Index enough_faces = 4000;  // to be worth waking threads for

ClosestFaceTree::ClosestFaceTree(const Points& vertices, const Faces& faces, double radius,
                                 const std::vector<std::uint8_t>* limbs)
    : m_faces(&faces), m_radius(radius), m_vertices(vertices) {
    if (limbs && are_limbs_of(faces, *limbs)) m_limbs = *limbs;
    build_nodes();
    mark_limbs();
    m_local.resize(static_cast<size_t>(vertices.rows()));
    localize();
    fit_nodes();
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
    const auto at_depth = [&](size_t depth) {
        return size_t(std::lower_bound(depths.begin(), depths.end(), depth) - depths.begin());
    };
    m_middle = {at_depth(middle_depth), at_depth(middle_depth + 1)};
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
    fit_nodes();
}

/// The box of the coordinates that are finite (m). Four points at a time: the compiler compares
/// several coordinates in one instruction.
static void find_bounds(const Points& x, Vec3& low, Vec3& high) {
    constexpr double unbounded = std::numeric_limits<double>::infinity();
    constexpr Eigen::Index together = 12;
    double least[together], most[together];
    std::fill_n(least, together, unbounded);
    std::fill_n(most, together, -unbounded);
    const auto take = [&](double at, Eigen::Index k) {
        least[k] = at < least[k] && at > -unbounded ? at : least[k];
        most[k] = at > most[k] && at < unbounded ? at : most[k];
    };
    Eigen::Index i = 0;
    for (; i + together <= x.size(); i += together)
        for (Eigen::Index k = 0; k < together; ++k) take(x.data()[i + k], k);
    for (Eigen::Index k = 0; i + k < x.size(); ++k) take(x.data()[i + k], k);
    for (Eigen::Index k = 0; k < 3; ++k) {
        low[k] = std::min({least[k], least[k + 3], least[k + 6], least[k + 9]});
        high[k] = std::max({most[k], most[k + 3], most[k + 6], most[k + 9]});
    }
}

/// Single-precision vertices relative to the centre: far from the world's origin the boxes stay
/// tight. Coordinates of 2^-24 relative precision are off by less than the padding.
void ClosestFaceTree::localize() {
    Vec3 low, high;
    find_bounds(m_vertices, low, high);
    m_origin = 0.5 * (low + high);
    if (!m_origin.allFinite()) m_origin.setZero();
    const double extent = (high - low).norm() + m_radius;
    m_padding = std::isfinite(extent) ? static_cast<float>(extent * 0x1p-21) : infinity;

    for (Eigen::Index i = 0; i < m_vertices.rows(); ++i) {
        const Vec3 x = m_vertices.row(i).transpose() - m_origin;
        m_local[static_cast<size_t>(i)] << x.cast<float>().array(), 0.0f;
    }
}

/// Children come after their parents, so one pass from the back is bottom-up. Several threads first
/// fit what is below the nodes of one level.
void ClosestFaceTree::fit_nodes() {
    const bool share = m_faces->rows() >= enough_faces && omp_get_max_threads() > 1;
    if (share) fit_below_middle();
    for (size_t i = share ? m_middle[0] : m_nodes.size(); i-- > 0;) fit_slots(m_nodes[i]);
}

void ClosestFaceTree::fit_below_middle() {
    constexpr int together = 4;
    const int first = static_cast<int>(m_middle[0]), end = static_cast<int>(m_middle[1]);
#pragma omp parallel for schedule(dynamic, 1)
    for (int i = first; i < end; i += together) fit_from_below(i, std::min(i + together, end));
}

/// Nodes of one level, which follow each other, and all below: their children do so, too.
void ClosestFaceTree::fit_from_below(int first, int end) {
    std::int32_t first_child = std::numeric_limits<std::int32_t>::max(), last_child = -1;
    for (int i = first; i < end; ++i)
        for (const std::int32_t child : m_nodes[static_cast<size_t>(i)].child) {
            if (child < 0) continue;
            first_child = std::min(first_child, child);
            last_child = std::max(last_child, child);
        }
    if (last_child >= 0) fit_from_below(first_child, last_child + 1);
    for (int i = first; i < end; ++i) fit_slots(m_nodes[static_cast<size_t>(i)]);
}

void ClosestFaceTree::fit_slots(Node& node) const {
    for (int slot = 0; slot < width; ++slot) {
        const std::int32_t child = node.child[slot];
        if (child < 0) {
            if (~child < m_faces->rows()) fit_leaf(node, slot, ~child);
            continue;
        }
        const Node& below = m_nodes[static_cast<size_t>(child)];
        for (int k = 0; k < 3; ++k) {
            node.low[k][slot] = below.low[k].minCoeff();
            node.high[k][slot] = below.high[k].maxCoeff();
        }
    }
}

void ClosestFaceTree::fit_leaf(Node& node, int slot, int face) const {
    const Vec4f& a = m_local[static_cast<size_t>((*m_faces)(face, 0))];
    const Vec4f& b = m_local[static_cast<size_t>((*m_faces)(face, 1))];
    const Vec4f& c = m_local[static_cast<size_t>((*m_faces)(face, 2))];
    const Vec4f sum = a + b + c;
    const bool finite = (sum - sum == 0.0f).all();  // Eigen's isFinite() takes one at a time
    const Vec4f low = a.min(b).min(c) - m_padding, high = a.max(b).max(c) + m_padding;
    for (int k = 0; k < 3; ++k) {
        node.low[k][slot] = finite ? low[k] : infinity;
        node.high[k][slot] = finite ? high[k] : -infinity;
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
    const EightFloats squared = box_distances(node.low, node.high, q);
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
        const EightFloats enter = box_entries(node.low, node.high, local, inverse,
                                              static_cast<float>(nearest) * 1.00001f);
        const EightSets limbs = load_eight<EightSets>(node.limbs) & ~ignored;
        Entry* const first = end;
        for (unsigned left = bits((enter < infinity) & (limbs != 0)); left != 0; left &= left - 1) {
            const int slot = __builtin_ctz(left);
            *end++ = {node.child[slot], enter[slot] * 0.99999f};
        }
        nearest_last(first, end);
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
