#include "collision/self/face_pairs.h"

#include <algorithm>

#include "collision/geometry/gather_in_order.h"

namespace cloth {
namespace {

// Pairs of nodes shared out, at least, for any number of threads: the order of what is found is
// theirs.
constexpr size_t task_count = 64;
constexpr Eigen::Index few_faces = 4000;  // fewer are not worth waking threads for

}  // namespace

FacePairs::FacePairs(const Points& rest, const Faces& faces)
    : m_tree(rest, faces), m_is_small(faces.rows() < few_faces) {
}

/// Replaces a pair of nodes by the pairs of children that are not apart.
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
    } else if (node(a).face_count >= node(b).face_count) {
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
            const MotionTree::Node& a = m_tree.node(task[0]);
            const MotionTree::Node& b = m_tree.node(task[1]);
            if (a.left < 0 && b.left < 0) {
                if (task[0] != task[1]) m_next_tasks.push_back(task);
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
        const MotionTree::Node& a = m_tree.node(task[0]);
        const MotionTree::Node& b = m_tree.node(task[1]);
        if (a.left >= 0 || b.left >= 0)
            expand(task, distance, [&](const Task& next) { stack.push_back(next); });
        else if (task[0] != task[1])
            result.push_back({std::min(a.face, b.face), std::max(a.face, b.face)});
    }
}

void FacePairs::find(const Points& x, const Points& motion, double distance, int threads) {
    m_found.clear();
    if (m_tree.is_empty()) return;
    m_tree.refit(x, motion);
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
