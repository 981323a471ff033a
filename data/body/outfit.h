#pragma once

#include <string>
#include <vector>

#include "data/body/body.h"
#include "data/body/garment_fit.h"
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
    int part_count() const { return static_cast<int>(first_vertex.size()) - 1; }
    /// Faces of one part; they are numbered as all vertices are.
    Faces faces_of_part(int part) const;
};

/// Loads garments by their names, from the outermost inwards: "tshirt+pants" is a T-shirt over
/// pants. A single name, or the path of a file, is that garment as load_garment() has it.
/// @throws LoadError naming the garments there are if there is no such one, ArgumentError if the
///         outer one cannot be got over the inner ones
Outfit load_outfit(const std::string& name, const Fabric& fabric = Fabric::soft_cotton());

/// The outfit as another body wears it: each part where the skin below it has moved to, clear of
/// it, and the outer parts over the inner ones. The rest shape moves as far as what is worn, so a
/// garment keeps its ease and its waistband.
/// @param from, to  the same person in two shapes, see Body::with_rest()
/// @throws ArgumentError as fit_garment() does, or if a part cannot be got over the inner ones
Outfit fit_outfit(const Outfit& outfit, const Body& from, const Body& to);

/// Positions (|V| x 3, m) at which the outfit is worn on another skin: each part where the skin
/// below it has moved to, clear of it, and the outer parts over the inner ones.
/// @param skin_from  on which it is worn at outfit.start
/// @param skin_to    its vertices elsewhere
/// @throws ArgumentError as fit_garment() does, or if a part cannot be got over the inner ones
Points wear_outfit(const Outfit& outfit, const TriMesh& skin_from, const Points& skin_to,
                   const GarmentFitSettings& settings = {});

/// The parts of an outfit's name.
std::vector<std::string> outfit_parts(const std::string& name);

}  // namespace cloth
