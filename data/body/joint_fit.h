#pragma once

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "data/body/skinning.h"

namespace cloth {

/// Finds how a skeleton's joints moved from where its skin is: the inverse of linear blend
/// skinning. Whoever sees a character's surface alone, as a Stepper does, thereby knows its pose.
///
///     const JointFit fit(body.rest(), body.weights());
///     if (fit.find(obstacle.x1, matrices) > 1e-3) { ... it is not this body ... }
///
/// x_i = sum over joints j of w_ij M_j (X_i, 1) is linear in the M_j, so they are the solution of
/// least squares with a constant matrix, which is factorised once. Of a skin that was skinned with
/// these weights they are exact.
class JointFit {
 public:
    /// @param rest       |V| x 3 (m)
    /// @param weights    of these vertices
    /// @param per_joint  vertices that are looked at, for each joint that moves them, 8 to 1e6;
    ///                   fewer cost less, more even out noise
    /// @throws ArgumentError if the weights are of other vertices, `per_joint` is out of range, or
    ///         the skin does not determine the joints that they name: each needs four vertices of
    ///         its own that are not in one plane
    JointFit(const Points& rest, const SkinWeights& weights, int per_joint = 64);

    Eigen::Index vertex_count() const { return m_vertices; }
    int joint_count() const { return m_joints; }
    /// Whether a vertex follows the joint. The others get identities.
    bool moves_skin(int joint) const { return m_unknown[static_cast<size_t>(joint)] >= 0; }

    /// @param skin      |V| x 3 (m)
    /// @param matrices  of all joints, from the rest pose to this one
    /// @return          root mean square distance of the vertices that are looked at from where
    ///                  these joints would have them (m); infinity, `matrices` untouched, if it has
    ///                  other vertices or numbers that are not finite
    double find(const Points& skin, std::vector<SkinMatrix>& matrices) const;

 private:
    void choose_rows(const SkinWeights& weights, int per_joint);

    Eigen::Index m_vertices;
    std::vector<int> m_rows;  ///< vertices that are looked at
    int m_joints = 0;
    std::vector<int> m_unknown;           ///< |joints|: which of those that move skin; -1: none
    Points m_centre;                      ///< of the vertices of each of these (m)
    VectorX m_radius;                     ///< around it (m)
    Eigen::SparseMatrix<double> m_blend;  ///< |rows| x 4 of these
    Eigen::LDLT<Eigen::MatrixXd> m_normal;
};

}  // namespace cloth
