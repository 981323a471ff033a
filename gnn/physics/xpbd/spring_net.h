#pragma once

#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// A linear spring between two vertices.
struct Spring {
    int a, b;
    double rest_length;    ///< (m)
    double stiffness;      ///< force per extension (N/m)
    double max_extension;  ///< beyond this extension (m) the force grows no more
};

/// One spring per edge e, for the membrane energy of the fabric:
///
///     k_e = Y (A0 + A1) / |e|^2,   Y = 4 mu (mu + lambda) / (2 mu + lambda)
///
/// with A0, A1 the areas of the edge's faces and Y Young's modulus of the sheet (Van Gelder 1998,
/// "Approximate simulation of elastic membranes by triangulated spring meshes"); without shear
/// stiffness mu there is none. A lattice of equilateral triangles, k = sqrt(3)/2 Y, is isotropic
/// and stretches under its own weight exactly like the fabric; in any mesh the mean of the
/// stiffness over all directions is that lattice's. An irregular mesh gives way where its springs
/// are out of balance: it hangs up to 10 % too far.
///
/// Springs know one constant only: their Poisson's ratio is 1/3 whatever the fabric's. For soft
/// cotton (0.485) shear is 11 % too stiff, stretch without side contraction 14 % and equal stretch
/// both ways 23 % too soft; for real cotton (0.3) all are within 5 %.
std::vector<Spring> stretch_springs(const Garment& garment);

/// One spring per hinge, between the corners opposite to its edge: they come nearer where the cloth
/// folds. With h0, h1 the heights of the hinge's faces over the edge, the distance across a hinge
/// of angle theta is nearly sqrt(h0^2 + h1^2 + 2 h0 h1 cos theta), of second order in theta, so
/// that the spring's energy is of fourth order where the bending energy k_h theta^2 / 2 (see
/// bending.h) is of second: no stiffness fits all angles. This one gives the bending energy of the
/// hinge that is folded by `fitted_angle` beyond its rest angle; flatter hinges are softer than the
/// fabric's, sharper ones stiffer.
///
/// The rest length is that of the garment's rest angle (by default 0, flat). The hinge can unfold,
/// but not beyond flat: more extension than that is the membrane's and meets no more force, or the
/// springs would stiffen the membrane by up to its own stiffness.
///
/// @param fitted_angle  (rad), 0.01 to 1.5; smaller is stiffer
std::vector<Spring> bending_springs(const Garment& garment, double fitted_angle);

}  // namespace cloth
