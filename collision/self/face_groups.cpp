#include "collision/self/face_groups.h"

#include "collision/geometry/gather_in_order.h"

namespace cloth {
namespace {

// Pairs of nodes shared out, at least, for any number of threads: the order of what is found is
// theirs.
constexpr size_t task_count = 64;
constexpr Eigen::Index few_faces = 4000;  // fewer are not worth waking threads for

}  // namespace

FaceGroups::FaceGroups(const Points& rest, const Faces& faces)
    : m_tree(rest, faces), m_is_small(faces.rows() < few_faces) {
    make_groups();
}

void FaceGroups::make_groups() {
    std::vector<int> stack;
    if (!m_tree.is_empty()) stack.push_back(0);
    while (!stack.empty()) {
        const int n = stack.back();
        stack.pop_back();
        if (m_group_of.size() <= static_cast<size_t>(n))
            m_group_of.resize(static_cast<size_t>(n) + 1, -1);
        const MotionTree::Node& node = m_tree.node(n);
        if (node.left >= 0 && node.face_count > size) {
            stack.push_back(node.right);
            stack.push_back(node.left);
            continue;
        }
        m_group_of[static_cast<size_t>(n)] = static_cast<int>(count());
        Lanes& leaves = m_leaves.emplace_back();
        Lanes& faces = m_faces.emplace_back();
        leaves.fill(-1);
        faces.fill(-1);
        int count = 0;
        add_leaves(n, count, leaves, faces);
    }
}

void FaceGroups::add_leaves(int n, int& count, Lanes& leaves, Lanes& faces) const {
    const MotionTree::Node& node = m_tree.node(n);
    if (node.left < 0) {
        leaves[static_cast<size_t>(count)] = n;
        faces[static_cast<size_t>(count++)] = node.face;
        return;
    }
    add_leaves(node.left, count, leaves, faces);
    add_leaves(node.right, count, leaves, faces);
}

/// Replaces a pair of nodes, of which not both are groups, by the pairs of children that are not
/// apart.
template <typename Emit>
void FaceGroups::expand(Task task, float distance, const Emit& emit) const {
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
void FaceGroups::make_tasks(float distance) {
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

void FaceGroups::run_task(size_t index, float distance, std::vector<Task>& result) {
    std::vector<Task>& stack = m_stacks[index];
    stack.assign(1, m_tasks[index]);
    while (!stack.empty()) {
        const Task task = stack.back();
        stack.pop_back();
        if (is_group(task[0]) && is_group(task[1]))
            result.push_back({group_of(task[0]), group_of(task[1])});
        else
            expand(task, distance, [&](const Task& next) { stack.push_back(next); });
    }
}

void FaceGroups::find(const Points& x, const Points& motion, double distance, int threads) {
    m_found.clear();
    if (m_tree.is_empty()) return;
    m_tree.refit(x, motion);
    const float reach = m_tree.widened(distance);
    make_tasks(reach);
    if (m_stacks.size() < m_tasks.size()) m_stacks.resize(m_tasks.size());
    gather_in_order(static_cast<int>(m_tasks.size()), worthwhile(threads), m_results, m_found,
                    [&](int task, std::vector<Task>& result) {
                        run_task(static_cast<size_t>(task), reach, result);
                    });
}

}  // namespace cloth
