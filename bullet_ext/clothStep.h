#pragma once

#include <vector>

#include "bullet_ext/anchoredBodies.h"
#include "bullet_ext/bulletObstacles.h"
#include "bullet_ext/pinchedCloth.h"
#include "gnn/stepper.h"

class btSoftBody;

namespace cloth {

/// One step of a Stepper, as reactions need it.
struct ClothStep {
    const Garment& garment;
    const Stepper& stepper;
    const Boundary& boundary;
    const ClothState& from;
    ClothState& to;                      ///< velocities of nodes that rigid bodies hold are changed
    double length;                       ///< (s)
    const std::vector<NearSolid>& near;  ///< what the cloth may touch, as it sees it
    const PinchedCloth& pinched;         ///< among them
    bool continues = false;              ///< the step before ended where this one starts
    /// Bodies that have moved with the cloth; null: none has.
    const AnchoredBodies* anchored = nullptr;
};

/// Nodes that goals hold at the end of the step: that are driven, or at a limit. What they take is
/// no body's.
std::vector<int> nodesHeldByGoals(const ClothStep& step);

/// Whether all that holds the cloth can be moved by it.
bool floatsFreely(const btSoftBody& body, const ClothStep& step);

/// Whether the solids near the cloth are all that its stepper saw.
bool allSolidsKnown(const ClothStep& step);

/// Whether no obstacle moves during the step: none does work then.
bool obstaclesStand(const Boundary& boundary);

}  // namespace cloth
