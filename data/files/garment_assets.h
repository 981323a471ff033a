#pragma once

#include <string>
#include <vector>

#include "data/core/cloth_state.h"
#include "data/core/garment.h"
#include "data/files/painted_mesh.h"

namespace cloth {

/// The committed garments for the default body, by name: tshirt, tshirt_1000, pants and so on.
/// Where vertices are left out of a name, it has those that its recipe says.
std::vector<std::string> garment_names();

/// Rest mesh of a garment of data/assets/garments by its name; or of one of your own by the path of
/// its file, which has an ending, such as my/shirt.obj.
/// @throws LoadError naming the garments there are if there is no such one, or if its file is
///         damaged
TriMesh load_garment_mesh(const std::string& name);

/// The same with what is painted on a garment of one's own; committed garments are not painted.
/// @throws LoadError as load_garment_mesh() and load_painted_mesh()
PaintedMesh load_painted_garment(const std::string& name,
                                 const std::optional<GoalColours>& colours = {});

/// The garment made of a fabric, without pins.
///
///     const Garment pants = load_garment("pants");
///     ClothState state = load_garment_start("pants");
///
/// @throws LoadError as load_garment_mesh(), ArgumentError if the fabric is not usable
Garment load_garment(const std::string& name, const Fabric& fabric = Fabric::soft_cotton());

/// The garment as the default body wears it in its rest pose, not moving: outside of the body. A
/// waistband is longer there than at rest; garments without a file NAME.worn.obj are worn at rest.
/// @throws LoadError as load_garment_mesh(), and if the worn shape has other faces
ClothState load_garment_start(const std::string& name);

}  // namespace cloth
