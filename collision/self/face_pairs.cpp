#include "collision/self/face_pairs.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include "collision/geometry/gather_in_order.h"

namespace cloth {
namespace {

// Pairs of nodes shared out, at least, for any number of threads: the order of what is found is
// theirs.
constexpr size_t task_count = 64;
constexpr Eigen::Index few_faces = 4000;  // fewer are not worth waking threads for

using Lanes = float __attribute__((vector_size(32)));
using Mask = std::int32_t __attribute__((vector_size(32)));
using Bytes = std::int8_t __attribute__((vector_size(8)));

Lanes load(const float* values) {
    Lanes lanes;
    std::memcpy(&lanes, values, sizeof(lanes));
    return lanes;
}

}  // namespace

FacePairs::FacePairs(const Points& rest, const Faces& faces)
    : m_tree(rest, faces), m_is_small(faces.rows() < few_faces) {
    make_groups();
}

void FacePairs::make_groups() {
    std::vector<int> stack;
    if (!m_tree.is_empty()) stack.push_back(0);
    while (!stack.empty()) {
        const int n = stack.back();
        stack.pop_back();
        if (m_group_of.size() <= static_cast<size_t>(n))
            m_group_of.resize(static_cast<size_t>(n) + 1, -1);
        const MotionTree::Node& node = m_tree.node(n);
        if (node.left >= 0 && node.face_count > group_size) {
            stack.push_back(node.right);
            stack.push_back(node.left);
            continue;
        }
        m_group_of[static_cast<size_t>(n)] = static_cast<int>(m_groups.size());
        Group& group = m_groups.emplace_back();
        std::fill(std::begin(group.leaf), std::end(group.leaf), -1);
        std::fill(std::begin(group.face), std::end(group.face), -1);
        int count = 0;
        add_leaves(n, count, group);
    }
}

void FacePairs::add_leaves(int n, int& count, Group& group) const {
    const MotionTree::Node& node = m_tree.node(n);
    if (node.left < 0) {
        group.leaf[count] = n;
        group.face[count++] = node.face;
        return;
    }
    add_leaves(node.left, count, group);
    add_leaves(node.right, count, group);
}

/// A lane without a face has a box that is apart from all.
void FacePairs::fill(Group& group) const {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (int lane = 0; lane < group_size; ++lane) {
        const int leaf = group.leaf[lane];
        for (int k = 0; k < 3; ++k) {
            const MotionTree::Box* box = leaf < 0 ? nullptr : &m_tree.node(leaf).box;
            group.low[k][lane] = box ? box->low[k] : infinity;
            group.high[k][lane] = box ? box->high[k] : -infinity;
            group.least_motion[k][lane] = box ? box->least_motion[k] : 0.0f;
            group.most_motion[k][lane] = box ? box->most_motion[k] : 0.0f;
        }
    }
}

/// Replaces a pair of nodes, of which not both are groups, by the pairs of children that are not
/// apart.
template <typename Emit>
void FacePairs::expand(Task task, float distance, const Emit& emit) const {
    const auto node = [&](int n) -> const MotionTree::Node& { return m_tree.node(n); };
    const auto emit_if_near = [&](int a, int b) {
        if (!MotionTree::are_apart(node(a).box, node(b).box, distance)) emit(Task{a, b});
    };
    const auto [a, b] = task;
    if (a == b) {
        emit(Task{node(a).left, node(a).left});
        emit(Task{node(a).right, node(a).right});
        emit_if_near(node(a).left, node(a).right);
    } else if (is_group(b) || (!is_group(a) && node(a).face_count >= node(b).face_count)) {
        emit_if_near(node(a).left, b);
        emit_if_near(node(a).right, b);
    } else {
        emit_if_near(a, node(b).left);
        emit_if_near(a, node(b).right);
    }
}

/// Expands the root, breadth first, until there are enough pairs of nodes to share out.
void FacePairs::make_tasks(float distance) {
    m_tasks.assign(1, Task{0, 0});
    bool grown = true;
    while (m_tasks.size() < task_count && grown) {
        grown = false;
        m_next_tasks.clear();
        for (const Task& task : m_tasks) {
            if (is_group(task[0]) && is_group(task[1])) {
                m_next_tasks.push_back(task);
                continue;
            }
            grown = true;
            expand(task, distance, [&](const Task& next) { m_next_tasks.push_back(next); });
        }
        m_tasks.swap(m_next_tasks);
    }
}

void FacePairs::run_task(size_t index, float distance, std::vector<std::array<int, 2>>& result) {
    std::vector<Task>& stack = m_stacks[index];
    stack.assign(1, m_tasks[index]);
    while (!stack.empty()) {
        const Task task = stack.back();
        stack.pop_back();
        if (is_group(task[0]) && is_group(task[1]))
            compare(task, distance, result);
        else
            expand(task, distance, [&](const Task& next) { stack.push_back(next); });
    }
}

/// MotionTree::are_apart() of each face of one group with all of the other.
void FacePairs::compare(Task nodes, float distance, std::vector<std::array<int, 2>>& result) const {
    const Group& a = m_groups[static_cast<size_t>(m_group_of[static_cast<size_t>(nodes[0])])];
    const Group& b = m_groups[static_cast<size_t>(m_group_of[static_cast<size_t>(nodes[1])])];
    const Lanes zero = {};
    for (int i = 0; i < group_size && a.face[i] >= 0; ++i) {
        Mask near = {-1, -1, -1, -1, -1, -1, -1, -1};
        for (int k = 0; k < 3; ++k) {
            const Lanes least = a.least_motion[k][i] - load(b.most_motion[k]);
            const Lanes most = a.most_motion[k][i] - load(b.least_motion[k]);
            const Lanes down = least < zero ? least : zero, up = most > zero ? most : zero;
            near &= (a.low[k][i] + down <= load(b.high[k]) + distance) &
                    (a.high[k][i] + up >= load(b.low[k]) - distance);
        }
        // one byte per lane, from the lowest one on
        const Bytes bytes = __builtin_convertvector(near, Bytes);
        std::uint64_t bits = 0;
        std::memcpy(&bits, &bytes, sizeof(bits));
        if (nodes[0] == nodes[1])  // each pair once
            bits &= i + 1 < group_size ? ~std::uint64_t{0} << (8 * (i + 1)) : 0;
        while (bits != 0) {
            const int lane = __builtin_ctzll(bits) / 8;
            bits &= ~(std::uint64_t{0xff} << (8 * lane));
            result.push_back(
                {std::min(a.face[i], b.face[lane]), std::max(a.face[i], b.face[lane])});
        }
    }
}

void FacePairs::find(const Points& x, const Points& motion, double distance, int threads) {
    m_found.clear();
    if (m_tree.is_empty()) return;
    m_tree.refit(x, motion);
    for (Group& group : m_groups) fill(group);
    const float reach = m_tree.widened(distance);
    make_tasks(reach);
    if (m_stacks.size() < m_tasks.size()) m_stacks.resize(m_tasks.size());
    const int workers = m_is_small ? 1 : threads;
    gather_in_order(static_cast<int>(m_tasks.size()), workers, m_results, m_found,
                    [&](int task, std::vector<std::array<int, 2>>& result) {
                        run_task(static_cast<size_t>(task), reach, result);
                    });
}

}  // namespace cloth
