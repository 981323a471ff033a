#include "gnn/train/skinned_start.h"

#include "collision/proximity/proximity.h"
#include "data/body/garment_skinning.h"
#include "data/core/check_range.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/train/kicks.h"

namespace cloth {

void SkinnedStartSettings::check() const {
    check_range("SkinnedStartSettings.share", share, 0.0, 1.0);
    check_range("SkinnedStartSettings.at_rest", at_rest, 0.0, 1.0);
    check_range("SkinnedStartSettings.noise", noise, 0.0, 0.02);
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
    const SkinGoals posed = skinned_goals(skin_garment(worn, body), body, time - dt, time);
    ClothState state = ClothState::at_rest(garment);
    state.time = time;
    state.x = posed.x1;
    if (!random.chance(settings.at_rest)) state.v = (posed.x1 - posed.x0) / dt;
    add_white_noise(garment, settings.noise, random, state.x);
    push_out_of(body, time, dt, state);
    return state;
}

}  // namespace cloth
