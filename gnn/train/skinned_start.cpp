#include "gnn/train/skinned_start.h"

#include <cmath>

#include "collision/proximity/proximity.h"
#include "data/body/skinning.h"
#include "data/core/check_range.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/train/body_world.h"
#include "gnn/train/kicks.h"

namespace cloth {

void SkinnedStartSettings::check() const {
    check_range("SkinnedStartSettings.share", share, 0.0, 1.0);
    check_range("SkinnedStartSettings.at_rest", at_rest, 0.0, 1.0);
    check_range("SkinnedStartSettings.noise", noise, 0.0, 0.02);
}

SkinWeights weights_from_skin(const Points& garment, const Body& body) {
    const SkinWeights& skin = body.weights();
    Eigen::MatrixXd dense =
        Eigen::MatrixXd::Zero(garment.rows(), static_cast<Eigen::Index>(body.joints().size()));
    for_each_skin_neighbour(
        garment, body.rest(), [&](Eigen::Index i, Eigen::Index vertex, double weight) {
            const auto v = static_cast<size_t>(vertex);
            for (int k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
                const auto influence = static_cast<size_t>(k);
                dense(i, skin.joints[influence]) += weight * skin.values[influence];
            }
        });
    return sparse_weights(dense, 8, 1e-3);
}

Points pose_garment(const Points& worn, const SkinWeights& weights, const AnimatedBody& body,
                    double time) {
    const JointTransforms transforms = body.joint_transforms(time);
    std::vector<SkinMatrix> matrices;
    matrices.reserve(transforms.size());
    for (const Eigen::Isometry3d& transform : transforms)
        matrices.emplace_back(transform.matrix().topRows<3>());
    return skin_points(worn, weights, matrices);
}

static void push_out_of(const AnimatedBody& body, double time, double dt, ClothState& state) {
    Boundary boundary;
    boundary.obstacles = {body.obstacle(time, time)};
    ProximitySettings settings;
    settings.threads = 1;
    SurfaceContacts contacts;
    Proximity(settings).query(state.x, boundary, contacts);
    ClothState still = state;
    still.v.setZero();
    projected_extrapolation(still, contacts, dt, PotentialSettings().contact_distance, state.x);
}

ClothState skinned_start(const Garment& garment, const Points& worn, const AnimatedBody& body,
                         const SkinnedStartSettings& settings, double time, double dt,
                         SceneRandom& random) {
    const SkinWeights weights = weights_from_skin(worn, body.body());
    ClothState state = ClothState::at_rest(garment);
    state.time = time;
    state.x = pose_garment(worn, weights, body, time);
    if (!random.chance(settings.at_rest))
        state.v = (state.x - pose_garment(worn, weights, body, time - dt)) / dt;
    add_white_noise(garment, settings.noise, random, state.x);
    push_out_of(body, time, dt, state);
    return state;
}

}  // namespace cloth
