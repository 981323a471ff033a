#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <optional>
#include <string>
#include <vector>

#include "bullet_ext/bulletTypes.h"
#include "data/core/garment.h"

namespace cloth {

/// "soft body 7 at 0x..." for messages: Bullet's user index (-1 if not set) and the address.
std::string softBodyName(const btSoftBody& body);

/// Cloth has faces and nothing that needs Bullet's own code: no tetrahedra, clusters, pressure,
/// volume conservation or pose matching.
bool isCloth(const btSoftBody& body);

/// Whether the faces have no border edge, as a ball's or a torus'.
bool isClosed(const btSoftBody& body);

/// Anchors of influence 1 are pins that follow their body; weaker ones pull, see softAnchors.h.
bool isHardAnchor(const btSoftBody::Anchor& anchor);

/// A node that is held by a link of a btMultiBody, by appendDeformableAnchor(): appendAnchor()
/// takes rigid bodies only. The node follows the link, which does not feel it.
struct LinkAnchor {
    int node;
    const btCollisionObject* link;
    btVector3 local;  ///< in the frame of the link (m)

    btVector3 place() const { return link->getWorldTransform() * local; }
};
std::vector<LinkAnchor> linkAnchors(const btSoftBody& body);
/// A node with a deformable anchor to a rigid body, which does nothing outside of Bullet's
/// deformable world; -1: there is none.
int idleAnchor(const btSoftBody& body);

/// Nodes that something else moves: zero inverse mass, or held by a hard anchor or a link. Sorted.
std::vector<int> pinnedNodes(const btSoftBody& body);

/// Positions of the nodes (|V| x 3, m).
Points nodePositions(const btSoftBody& body);

/// Faces as node numbers (|F| x 3), in the body's own orientation.
Faces faceNodes(const btSoftBody& body);

/// The garment that a soft body is: faces turned to one orientation, rest lengths of its links,
/// pins from its nodes. The shape of a body that Bullet has not stepped yet is its rest shape, as
/// for Bullet itself.
///
/// Masses: cloth moves by the ratio of stiffness to mass, and a Bullet user's masses (1 kg per node
/// by default) mean nothing to Bullet's own solver. So the garment has the fabric's density unless
/// `use_body_density`; node masses turn forces into accelerations.
///
/// @throws ArgumentError naming the body, the node or edge, and the remedy
Garment garmentOfSoftBody(const btSoftBody& body, Fabric fabric, bool use_body_density);
/// The same of a given rest shape (|V| x 3, m).
Garment garmentOfSoftBody(const btSoftBody& body, Fabric fabric, const Points& rest,
                          bool rest_angles);

/// The body's mass over the garment's, both of the nodes that are free or anchored: times
/// garment.masses() these are the masses that the body's cloth moves with.
double massRatio(const btSoftBody& body, const Garment& garment);

/// Throws ArgumentError unless the body is cloth with finite nodes and usable masses.
void checkCloth(const btSoftBody& body);

/// Throws ArgumentError unless the garment has the nodes and faces of the body.
void checkGarmentFits(const btSoftBody& body, const Garment& garment);

/// A number that changes when nodes or faces are added, removed or renumbered.
size_t topologySignature(const btSoftBody& body);

/// Rest lengths of the links that are not bending links (m), as Bullet will have them in its next
/// step.
std::vector<double> restLengths(const btSoftBody& body);
/// Lengths of the same links where the nodes are at x (|V| x 3, m).
std::vector<double> lengthsAt(const btSoftBody& body, const Points& x);

/// The one factor that takes all numbers of `from` to those of `to`, within a thousandth of it;
/// none if there is none, or their number is not the same.
std::optional<double> commonFactor(const std::vector<double>& from, const std::vector<double>& to);

/// The garment after nodes were added to its body, as by a cut: nodes that were there keep their
/// rest positions, new ones get those of the places of the old cloth where they are now. None if
/// nodes were removed or moved at the same time.
/// @param shown  |V before| x 3 (m): where the nodes were
/// @throws ArgumentError if the new faces are none of a garment
std::optional<Garment> garmentAfterCut(const btSoftBody& body, const Garment& before,
                                       const Points& shown);

}  // namespace cloth
