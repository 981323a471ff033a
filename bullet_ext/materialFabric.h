#pragma once

#include "data/core/fabric.h"

class btSoftBody;

namespace cloth {

/// The fabric that a body's materials stand for. Bullet's stiffnesses are shares of a correction
/// per iteration, not of physics, so this is a rule, not a conversion:
///
/// - Young's modulus (N/m) is 33 (5000 / 33)^s, s the mean m_kLST (0 to 1) of the links along
/// edges:
///   soft cotton at 0, real cotton at 1, Bullet's default; Poisson's ratio 0.3. Without links s
///   = 1.
/// - Bending stiffness (N m) is 4e-6 without bending links, else 4e-5 10^b with b their mean
/// m_kLST.
///
/// m_kAST and m_kVST have no part in Bullet's cloth and none here.
/// @param density  (kg/m^2)
Fabric fabricOfMaterials(const btSoftBody& body, double density);

}  // namespace cloth
