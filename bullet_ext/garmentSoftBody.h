#pragma once

#include "bullet_ext/bulletTypes.h"
#include "data/core/cloth_state.h"
#include "data/core/garment.h"

class btSoftBody;
struct btSoftBodyWorldInfo;

namespace cloth {

/// How Bullet's own solver is set up for cloth that a competent user ships.
struct SoftBodySettings {
    int iterations = 10;     ///< position iterations, 1 to 1000: with 1 Bullet's cloth explodes
    double margin = 4e-3;    ///< distance kept from obstacles (m), 1e-4 to 0.25; Bullet's own: 0.25
    double stiffness = 1.0;  ///< kLST of the edges, 0 to 1
    double bending = 0.1;    ///< kLST of the links across hinges, 0 to 1; 0: no such links
    double friction = 1.0;   ///< kDF, times the obstacle's friction, 0 to 1
    double contact_hardness =
        1.0;  ///< kCHR and kKHR, 0 to 1; Bullet's kKHR of 0.1 lets cloth through
};

/// @throws ArgumentError naming the setting that is out of range
void checkSoftBodySettings(const SoftBodySettings& settings);

/// A Bullet soft body equal to the garment: node i is vertex i, face f is face f; the garment's
/// masses, pins as zero inverse mass, a link per edge and a bending link across each hinge, with
/// rest lengths of the rest mesh. It belongs to the caller, like every btSoftBody.
///
/// @param info   kept by reference, as Bullet does: broadphase, dispatcher, gravity
/// @param state  where the nodes are and how they move; their rest lengths do not depend on it
btSoftBody* createGarmentSoftBody(btSoftBodyWorldInfo& info, const Garment& garment,
                                  const ClothState& state, const SoftBodySettings& settings = {});
/// The same in the rest pose.
btSoftBody* createGarmentSoftBody(btSoftBodyWorldInfo& info, const Garment& garment,
                                  const SoftBodySettings& settings = {});

/// Writes positions and velocities into the nodes, as if the body had got there by itself.
void loadState(const ClothState& state, btSoftBody& body);
/// Positions and velocities of the nodes; `time` is left alone.
void storeState(const btSoftBody& body, ClothState& state);

}  // namespace cloth
