#pragma once

#include <string>

#include "data/core/garment.h"

namespace cloth {

/// Rest mesh of a garment of data/assets/garments by its name: tshirt, tshirt_2000, tshirt_1000.
/// @throws LoadError if there is no such garment or its file is damaged
TriMesh load_garment_mesh(const std::string& name);

/// The garment made of a fabric, without pins.
///
///     const Garment shirt = load_garment("tshirt");
///
/// @throws LoadError as load_garment_mesh(), ArgumentError if the fabric is not usable
Garment load_garment(const std::string& name, const Fabric& fabric = Fabric::soft_cotton());

}  // namespace cloth
