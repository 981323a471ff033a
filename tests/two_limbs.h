#pragma once

#include <algorithm>
#include <memory>

#include "tests/test_meshes.h"

namespace cloth::test {

/// A ball (limb 0) around the origin and a smaller one (limb 1) in one mesh.
/// @param joined  by a face between them, as an arm is to its trunk
class TwoLimbs {
 public:
    explicit TwoLimbs(bool joined) {
        const TriMesh ball = icosphere(3);
        m_count = ball.vertices.rows();
        m_ball = ball.vertices;
        Faces faces(2 * ball.faces.rows() + (joined ? 1 : 0), 3);
        faces.topRows(ball.faces.rows()) = ball.faces;
        faces.middleRows(ball.faces.rows(), ball.faces.rows()) =
            ball.faces.array() + static_cast<int>(m_count);
        if (joined) {
            Eigen::Index out = 0, in = 0;  // where they meet
            ball.vertices.col(0).maxCoeff(&out);
            ball.vertices.col(0).minCoeff(&in);
            const int a = static_cast<int>(m_count + in), b = static_cast<int>(out);
            faces.bottomRows(1) << a, b, b;
        }
        auto limbs = std::make_shared<std::vector<std::uint8_t>>(size_t(faces.rows()), 1);
        std::fill_n(limbs->begin(), ball.faces.rows(), 0);
        m_faces = std::make_shared<const Faces>(faces);
        m_limbs = limbs;
    }

    /// The arm's centre moves along x from `from` to `to`.
    Boundary boundary(double from, double to) const {
        Obstacle body;
        body.faces = m_faces;
        body.limbs = m_limbs;
        body.x0 = vertices(from);
        body.x1 = vertices(to);
        return boundary_of({body});
    }

 private:
    Points vertices(double x) const {
        Points all(2 * m_count, 3);
        all << 0.15 * m_ball, (0.05 * m_ball).rowwise() + Eigen::RowVector3d(x, 0, 0);
        return all;
    }
    Eigen::Index m_count;
    Points m_ball;
    std::shared_ptr<const Faces> m_faces;
    std::shared_ptr<const std::vector<std::uint8_t>> m_limbs;
};

}  // namespace cloth::test
