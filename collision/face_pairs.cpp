#include "collision/face_pairs.h"

#include <algorithm>
#include <cmath>

#include "collision/gather_in_order.h"

namespace cloth {
namespace {

// Pairs of nodes shared out, at least, for any number of threads: the order of what is found is
// theirs.
constexpr size_t task_count = 64;
constexpr Eigen::Index few_faces = 4000;  // fewer are not worth waking threads for

}  // namespace

FacePairs::FacePairs(const Points& rest, const Faces& faces) : m_faces(faces) {
    for (const BinaryNode& node : build_fcl_hierarchy(rest, faces)) {
        m_nodes.emplace_back();
        m_nodes.back().left = node.left;
        m_nodes.back().right = node.right;
        m_nodes.back().face = node.face;
        m_nodes.back().face_count = node.face_count;
    }
}

void FacePairs::refit_leaf(Node& node, const Points& x, const Points& motion) const {
    const auto corners = m_faces.row(node.face);
    for (int k = 0; k < 3; ++k) {
        const double a = x(corners[0], k), b = x(corners[1], k), c = x(corners[2], k);
        const double u = motion(corners[0], k), v = motion(corners[1], k),
                     w = motion(corners[2], k);
        node.low[k] = static_cast<float>(std::min({a, b, c}) - m_origin[k]);
        node.high[k] = static_cast<float>(std::max({a, b, c}) - m_origin[k]);
        node.least_motion[k] = static_cast<float>(std::min({u, v, w}));
        node.most_motion[k] = static_cast<float>(std::max({u, v, w}));
    }
}

void FacePairs::refit(const Points& x, const Points& motion) {
    m_origin = x.row(m_faces(0, 0));
    const double size = (x.rowwise() - m_origin).cwiseAbs().maxCoeff();
    m_rounding = static_cast<float>(1e-6 * (size + motion.cwiseAbs().maxCoeff()));
    for (size_t n = m_nodes.size(); n-- > 0;) {
        Node& node = m_nodes[n];
        for (float* lane : {node.low, node.high, node.least_motion, node.most_motion})
            lane[3] = 0.0f;
        if (node.left < 0) {
            refit_leaf(node, x, motion);
            continue;
        }
        const Node& a = m_nodes[static_cast<size_t>(node.left)];
        const Node& b = m_nodes[static_cast<size_t>(node.right)];
        for (int k = 0; k < 4; ++k) {
            node.low[k] = std::min(a.low[k], b.low[k]);
            node.high[k] = std::max(a.high[k], b.high[k]);
            node.least_motion[k] = std::min(a.least_motion[k], b.least_motion[k]);
            node.most_motion[k] = std::max(a.most_motion[k], b.most_motion[k]);
        }
    }
}

/// Whether the box of a, drawn along the motions that its points can have as seen from b, stays
/// further than the distance from the box of b in one of the coordinates.
bool FacePairs::are_apart(const Node& a, const Node& b, float distance) {
    bool apart = false;
    for (int k = 0; k < 4; ++k) {
        const float down = std::min(0.0f, a.least_motion[k] - b.most_motion[k]);
        const float up = std::max(0.0f, a.most_motion[k] - b.least_motion[k]);
        apart |= (a.low[k] + down > b.high[k] + distance) | (a.high[k] + up < b.low[k] - distance);
    }
    return apart;
}

/// Replaces a pair of nodes by the pairs of children that are not apart.
template <typename Emit>
void FacePairs::expand(Task task, float distance, const Emit& emit) const {
    const auto node = [&](int n) -> const Node& { return m_nodes[static_cast<size_t>(n)]; };
    const auto emit_if_near = [&](int a, int b) {
        if (!are_apart(node(a), node(b), distance)) emit(Task{a, b});
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
            const Node& a = m_nodes[static_cast<size_t>(task[0])];
            const Node& b = m_nodes[static_cast<size_t>(task[1])];
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
        const Node& a = m_nodes[static_cast<size_t>(task[0])];
        const Node& b = m_nodes[static_cast<size_t>(task[1])];
        if (a.left >= 0 || b.left >= 0)
            expand(task, distance, [&](const Task& next) { stack.push_back(next); });
        else if (task[0] != task[1])
            result.push_back({std::min(a.face, b.face), std::max(a.face, b.face)});
    }
}

void FacePairs::find(const Points& x, const Points& motion, double distance, int threads) {
    m_found.clear();
    if (m_nodes.empty()) return;
    refit(x, motion);
    const float reach = static_cast<float>(distance) * (1.0f + 1e-6f) + 4.0f * m_rounding;
    make_tasks(reach);
    if (m_stacks.size() < m_tasks.size()) m_stacks.resize(m_tasks.size());
    const int workers = m_faces.rows() < few_faces ? 1 : threads;
    gather_in_order(static_cast<int>(m_tasks.size()), workers, m_results, m_found,
                    [&](int task, std::vector<std::array<int, 2>>& result) {
                        run_task(static_cast<size_t>(task), reach, result);
                    });
}

}  // namespace cloth
