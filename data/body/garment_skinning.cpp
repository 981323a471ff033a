#include "data/body/garment_skinning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "data/core/errors.h"

namespace cloth {
namespace {

int joint_count(const SkinWeights& weights) {
    const auto last = std::max_element(weights.joints.begin(), weights.joints.end());
    return last == weights.joints.end() ? 0 : *last + 1;
}

void check_skin(const Points& worn, const TriMesh& skin, const SkinWeights& weights) {
    if (skin.faces.rows() == 0)
        throw ArgumentError("GarmentSkinning: skin", "it has no face", "give the character's skin");
    if (weights.vertex_count() != skin.vertices.rows())
        throw ArgumentError("GarmentSkinning: weights",
                            "are of " + std::to_string(weights.vertex_count()) +
                                " vertices, the skin has " + std::to_string(skin.vertices.rows()),
                            "give the weights of this skin");
    if (!worn.allFinite() || !skin.vertices.allFinite())
        throw ArgumentError("GarmentSkinning", "a position is not finite",
                            "give finite positions in metres");
}

template <class Character>
SkinGoals goals_of(const GarmentSkinning& skinning, const Character& character, double t0,
                   double t1) {
    SkinGoals goals;
    skinning.pose(character.skin_matrices(t0), goals.x0, goals.normal0);
    skinning.pose(character.skin_matrices(t1), goals.x1, goals.normal1);
    return goals;
}

}  // namespace

void for_each_skin_neighbour(const Points& garment, const Points& skin,
                             const std::function<void(Eigen::Index, Eigen::Index, double)>& use) {
    const double width = 0.03;
    VectorX squared(skin.rows());
    std::vector<std::pair<Eigen::Index, double>> near;
    for (Eigen::Index i = 0; i < garment.rows(); ++i) {
        squared = (skin.rowwise() - garment.row(i)).rowwise().squaredNorm();
        const double nearest = squared.minCoeff();
        double sum = 0.0;
        near.clear();
        for (Eigen::Index k = 0; k < squared.size(); ++k) {
            const double exponent = (squared[k] - nearest) / (2.0 * width * width);
            if (exponent > 9.0) continue;
            near.emplace_back(k, std::exp(-exponent));
            sum += near.back().second;
        }
        for (const auto& [vertex, weight] : near) use(i, vertex, weight / sum);
    }
}

GarmentSkinning::GarmentSkinning(Points worn, const TriMesh& skin, const SkinWeights& weights)
    : m_worn(std::move(worn)) {
    check_skin(m_worn, skin, weights);
    m_joints = joint_count(weights);
    const Points skin_normals = vertex_normals(skin.vertices, skin.faces);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(m_worn.rows(), m_joints);
    VectorX squared = VectorX::Constant(m_worn.rows(), std::numeric_limits<double>::infinity());
    m_normals.setZero(m_worn.rows(), 3);
    for_each_skin_neighbour(
        m_worn, skin.vertices, [&](Eigen::Index i, Eigen::Index vertex, double weight) {
            const auto v = static_cast<size_t>(vertex);
            for (int k = weights.begin[v]; k < weights.begin[v + 1]; ++k) {
                const auto influence = static_cast<size_t>(k);
                dense(i, weights.joints[influence]) += weight * weights.values[influence];
            }
            m_normals.row(i) += weight * skin_normals.row(vertex);
            squared[i] =
                std::min(squared[i], (skin.vertices.row(vertex) - m_worn.row(i)).squaredNorm());
        });
    m_weights = sparse_weights(dense, 8, 1e-3);
    m_normals.rowwise().normalize();
    if (m_worn.rows() > 0) m_farthest = std::sqrt(squared.maxCoeff());
}

void GarmentSkinning::pose(const std::vector<SkinMatrix>& matrices, Points& x,
                           Points& normals) const {
    if (static_cast<int>(matrices.size()) < m_joints)
        throw ArgumentError("GarmentSkinning::pose",
                            "there are " + std::to_string(matrices.size()) +
                                " matrices, the weights name " + std::to_string(m_joints) +
                                " joints",
                            "give one per joint of the character");
    x = skin_points(m_worn, m_weights, matrices);
    std::vector<SkinMatrix> turns = matrices;
    for (SkinMatrix& turn : turns) turn.col(3).setZero();
    normals = skin_points(m_normals, m_weights, turns);
    normals.rowwise().normalize();
}

GarmentSkinning skin_garment(const Points& worn, const AnimatedBody& body) {
    return {worn, body.body().rest_mesh(), body.body().weights()};
}

GarmentSkinning skin_garment(const Points& worn, const WeldedCharacter& character) {
    return {worn, character.rest(), character.weights()};
}

SkinGoals skinned_goals(const GarmentSkinning& skinning, const AnimatedBody& body, double t0,
                        double t1) {
    return goals_of(skinning, body, t0, t1);
}

SkinGoals skinned_goals(const GarmentSkinning& skinning, const WeldedCharacter& character,
                        double t0, double t1) {
    return goals_of(skinning, character, t0, t1);
}

}  // namespace cloth
