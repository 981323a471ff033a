#include "collision/geometry/motion_tree.h"

#include <algorithm>
#include <cmath>

namespace cloth {

constexpr double rounding = 1e-6;  // of single precision, with room for what is done with it

MotionTree::MotionTree(const Points& rest, const Faces& faces) : m_faces(faces) {
    for (const BinaryNode& node : build_fcl_hierarchy(rest, faces))
        m_nodes.push_back({{}, node.left, node.right, node.face, node.face_count});
}

void MotionTree::localize(const Points& x, const Points& motion) {
    m_origin = x.row(m_faces(0, 0));
    const auto count = static_cast<size_t>(x.rows());
    m_at.resize(count);
    m_motion.resize(count);
    double size = 0.0, farthest = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const Vec3 at = x.row(static_cast<Eigen::Index>(i)) - m_origin;
        const Vec3 moves = motion.row(static_cast<Eigen::Index>(i));
        size = std::max(size, at.cwiseAbs().maxCoeff());
        farthest = std::max(farthest, moves.cwiseAbs().maxCoeff());
        m_at[i] << at.cast<float>().array(), 0.0f;
        m_motion[i] << moves.cast<float>().array(), 0.0f;
    }
    m_rounding = static_cast<float>(rounding * (size + farthest));
}

void MotionTree::refit_leaf(Node& node) const {
    const auto corners = m_faces.row(node.face);
    const auto of = [&](const std::vector<Vec4f>& values, int k) -> const Vec4f& {
        return values[static_cast<size_t>(corners[k])];
    };
    const auto store = [](const Vec4f& value, float* lanes) { Eigen::Map<Vec4f>{lanes} = value; };
    const Vec4f &a = of(m_at, 0), &b = of(m_at, 1), &c = of(m_at, 2);
    const Vec4f &u = of(m_motion, 0), &v = of(m_motion, 1), &w = of(m_motion, 2);
    store(a.min(b).min(c), node.box.low);
    store(a.max(b).max(c), node.box.high);
    store(u.min(v).min(w), node.box.least_motion);
    store(u.max(v).max(w), node.box.most_motion);
}

void MotionTree::refit(const Points& x, const Points& motion) {
    if (m_nodes.empty()) return;
    localize(x, motion);
    for (size_t n = m_nodes.size(); n-- > 0;) {
        if (m_nodes[n].left < 0) {
            refit_leaf(m_nodes[n]);
            continue;
        }
        Box& box = m_nodes[n].box;
        const Box& a = node(m_nodes[n].left).box;
        const Box& b = node(m_nodes[n].right).box;
        for (int k = 0; k < 4; ++k) {
            box.low[k] = std::min(a.low[k], b.low[k]);
            box.high[k] = std::max(a.high[k], b.high[k]);
            box.least_motion[k] = std::min(a.least_motion[k], b.least_motion[k]);
            box.most_motion[k] = std::max(a.most_motion[k], b.most_motion[k]);
        }
    }
}

MotionTree::Box MotionTree::box_of(const Vec3& x, const Vec3& motion) const {
    Box box;
    for (float* lane : {box.low, box.high, box.least_motion, box.most_motion}) lane[3] = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const double at = x[k] - m_origin[k];
        const double wide = rounding * (std::abs(at) + std::abs(motion[k]));
        box.low[k] = static_cast<float>(at - wide);
        box.high[k] = static_cast<float>(at + wide);
        box.least_motion[k] = box.most_motion[k] = static_cast<float>(motion[k]);
    }
    return box;
}

}  // namespace cloth
