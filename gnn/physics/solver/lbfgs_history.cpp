#include "gnn/physics/solver/lbfgs_history.h"

#include "gnn/physics/solver/dot.h"

namespace cloth {

void LbfgsHistory::allocate(int capacity, Eigen::Index rows) {
    m_pairs.resize(static_cast<size_t>(capacity));
    for (Pair& pair : m_pairs) {
        pair.step.resize(rows, 3);
        pair.change.resize(rows, 3);
    }
    m_size = m_next = 0;
}

void LbfgsHistory::push(const Points& step, const Points& gradient_before,
                        const Points& gradient_after) {
    if (m_pairs.empty()) return;
    Pair& slot = m_pairs[static_cast<size_t>(m_next)];
    slot.change = gradient_after - gradient_before;
    slot.step = step;
    const double curvature = dot(slot.step, slot.change);
    if (!(curvature > 1e-10 * slot.step.norm() * slot.change.norm())) {
        // The slot may have held the oldest pair, which is overwritten now.
        m_size = std::min(m_size, static_cast<int>(m_pairs.size()) - 1);
        return;
    }
    slot.inverse_curvature = 1.0 / curvature;
    m_next = (m_next + 1) % static_cast<int>(m_pairs.size());
    m_size = std::min(m_size + 1, static_cast<int>(m_pairs.size()));
}

LbfgsHistory::Pair& LbfgsHistory::pair(int age) {
    const int capacity = static_cast<int>(m_pairs.size());
    return m_pairs[static_cast<size_t>((m_next - 1 - age + capacity) % capacity)];
}

void LbfgsHistory::first_loop(Points& q) {
    for (int age = 0; age < m_size; ++age) {
        Pair& p = pair(age);
        p.alpha = p.inverse_curvature * dot(p.step, q);
        q -= p.alpha * p.change;
    }
}

void LbfgsHistory::second_loop(Points& z) {
    for (int age = m_size - 1; age >= 0; --age) {
        const Pair& p = pair(age);
        z += (p.alpha - p.inverse_curvature * dot(p.change, z)) * p.step;
    }
}

}  // namespace cloth
