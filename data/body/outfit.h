#pragma once

#include <string>
#include <vector>

#include "data/core/cloth_state.h"
#include "data/core/garment.h"

namespace cloth {

/// Garments that are worn together. They are one Garment (see merge_garments()): a solver steps
/// them together, and with self-contact on they keep off each other.
struct Outfit {
    Garment garment;
    ClothState start;               ///< as the default body wears it in its rest pose, not moving
    std::vector<int> first_vertex;  ///< of each part, and at the end the number of all vertices

    static constexpr double thickness = 4e-3;  ///< of the self-contact that layers need (m)
    static constexpr double gap = 6e-3;        ///< between the parts at the start (m)

    bool has_layers() const { return first_vertex.size() > 2; }
};

/// Loads garments by their names, from the outermost inwards: "tshirt+pants" is a T-shirt over
/// pants. A single name, or the path of a file, is that garment as load_garment() has it.
/// @throws LoadError naming the garments there are if there is no such one, ArgumentError if the
///         outer one cannot be got over the inner ones
Outfit load_outfit(const std::string& name, const Fabric& fabric = Fabric::soft_cotton());

/// The parts of an outfit's name.
std::vector<std::string> outfit_parts(const std::string& name);

}  // namespace cloth
