#include "gnn/skinning/skinning_predictor.h"

#include <algorithm>
#include <string>
#include <utility>

#include "data/core/errors.h"

namespace cloth {

static const SkinningWeights& checked(const Garment& garment, const SkinningWeights* weights) {
    if (!weights)
        throw ArgumentError("skinning weights", "are null", "load them with SkinningWeights::load");
    const std::string subject = "garment " + garment.name(),
                      remedy = "train a network for this garment with train_skinning";
    if (garment.vertex_count() != weights->config.vertices)
        throw ArgumentError(subject,
                            "has " + std::to_string(garment.vertex_count()) +
                                " vertices, the network is of " + weights->config.garment +
                                " with " + std::to_string(weights->config.vertices),
                            remedy);
    const double difference =
        (garment.rest().vertices - weights->points("rest")).rowwise().norm().maxCoeff();
    if (!(difference < 1e-3))
        throw ArgumentError(
            subject,
            "has another rest shape than " + weights->config.garment + ", which the network is of",
            remedy);
    return *weights;
}

static JointFit fit_of(const Body* body) {
    if (!body)
        throw ArgumentError("body", "is null", "give the body that the network was trained on");
    return {body->rest(), body->weights()};
}

SkinningPredictor::SkinningPredictor(const Garment& garment,
                                     std::shared_ptr<const SkinningWeights> weights,
                                     std::shared_ptr<const Body> body)
    : m_weights(std::move(weights)),
      m_body(std::move(body)),
      m_fit(fit_of(m_body.get())),
      m_features(checked(garment, m_weights.get()).config, *m_body),
      m_network(*m_weights),
      m_skin(m_weights->skin(m_features.joints())),
      m_worn(m_weights->points("worn")) {
}

/// Leaves its joints at t + dt in m_matrices1.
const Obstacle* SkinningPredictor::find_body(const Boundary& boundary) {
    for (const Obstacle& obstacle : boundary.obstacles)
        if (obstacle.shape == ObstacleShape::mesh && obstacle.x0.rows() == m_fit.vertex_count() &&
            m_fit.find(obstacle.x1, m_matrices1) < most_misfit)
            return &obstacle;
    return nullptr;
}

/// Makes the pose at t the newest of m_seen. After a skin that is not where the last step ended,
/// such as the first one, the body counts as having stood still.
void SkinningPredictor::remember(const Points& skin0) {
    const bool goes_on = !m_seen.empty() && (skin0 - m_last_skin).cwiseAbs().maxCoeff() < 1e-4;
    if (goes_on) return;
    m_fit.find(skin0, m_matrices0);
    m_seen.assign(1, m_features.see(m_matrices0));
}

bool SkinningPredictor::predict(const Boundary& boundary, Points& x) {
    const Obstacle* body = find_body(boundary);
    if (!body || !body->x0.allFinite()) return false;
    remember(body->x0);
    const SeenPose now = m_features.see(m_matrices1);
    std::vector<const SeenPose*> poses = {&now};
    for (size_t k = 1; k < config().ages.size(); ++k) {
        const size_t before = static_cast<size_t>(config().ages[k]) - 1;
        poses.push_back(&m_seen[std::min(before, m_seen.size() - 1)]);
    }
    m_features.build(poses, boundary.gravity, m_input);
    m_network.evaluate(m_input, m_displacement);
    x = skin_points(m_worn + m_displacement, m_skin, m_matrices1);
    m_seen.push_front(now);
    if (m_seen.size() > static_cast<size_t>(config().ages.back()) + 1) m_seen.pop_back();
    m_last_skin = body->x1;
    return true;
}

}  // namespace cloth
