#include "gnn/train/skinning_loss.h"

namespace cloth {

static ProximitySettings one_thread() {
    ProximitySettings settings;
    settings.threads = 1;
    return settings;
}

SkinningLoss::SkinningLoss(const Garment& garment, double dt)
    : m_dt(dt), m_proximity(one_thread()), m_potential(garment) {
    m_boundary.obstacles.resize(1);
    m_boundary.pin_targets.resize(0, 3);
}

void SkinningLoss::evaluate(LossKind kind, const Obstacle& body, double contact_weight,
                            const Points& before, const Points& now, const Points& next,
                            LossValue& loss) {
    const ClothState state{now, (now - before) / m_dt, 0.0};
    m_boundary.obstacles[0] = body;
    m_proximity.query(now, m_boundary, m_contacts);
    m_potential.set_contact_weight(contact_weight);
    m_potential.begin_step(state, m_boundary, m_contacts, m_dt);
    LossProblem problem;
    problem.potential = &m_potential;
    problem.boundary = &m_boundary;
    problem.base = &now;
    problem.scale = m_boundary.gravity.norm() * m_dt * m_dt;
    evaluate_loss(kind, problem, next, loss);
}

Points unskinned(const Points& gradient, const SkinWeights& weights,
                 const std::vector<SkinMatrix>& matrices) {
    Points result(gradient.rows(), 3);
    for (int i = 0; i < weights.vertex_count(); ++i) {
        Eigen::Matrix3d blend = Eigen::Matrix3d::Zero();
        for (int k = weights.begin[static_cast<size_t>(i)];
             k < weights.begin[static_cast<size_t>(i) + 1]; ++k)
            blend +=
                weights.values[static_cast<size_t>(k)] *
                matrices[static_cast<size_t>(weights.joints[static_cast<size_t>(k)])].leftCols<3>();
        result.row(i) = gradient.row(i) * blend;
    }
    return result;
}

}  // namespace cloth
