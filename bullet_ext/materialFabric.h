#pragma once

#include "data/core/fabric.h"

class btSoftBody;

namespace cloth {

/// The fabric that a body's materials stand for. Bullet's stiffnesses are shares of a correction
/// per iteration, so how far its cloth stretches follows from masses' ratios, the time step and
/// the mesh, and not from kilograms. This is a rule, not a conversion:
///
/// - All stiffness is per mass: a body of twice the mass moves the same, as with Bullet's solver.
///   The fabric has the density of cotton, 0.2 kg/m^2, whatever the body weighs.
/// - Young's modulus (N/m) is 33 + (5000 - 33) s, s the mean m_kLST (0 to 1) of the links along
///   edges: real cotton at 1, Bullet's default. What Bullet's links yield goes with 1 / m_kLST,
///   too. Poisson's ratio is 0.3. Without links s = 1.
/// - Bending stiffness (N m) is 84 l^4 sqrt(b), at least 4e-6, with l the mean rest length of the
///   links along edges (m) and b the mean m_kLST of the bending links; 4e-6 without these. Strips
///   clamped at one end hang as Bullet's do at 60 Hz with one iteration, within a factor of three
///   of the stiffness, for edges of 0.02 to 0.5 m. More iterations stiffen Bullet's, not ours.
///   Above 1 N m the fabric is made lighter instead, and softer as much.
///
/// m_kAST and m_kVST have no part in Bullet's cloth and none here.
Fabric fabricOfMaterials(const btSoftBody& body);

}  // namespace cloth
