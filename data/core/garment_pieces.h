#pragma once

#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// |V|: number of the connected piece that each vertex belongs to, from 0 in the order of vertices.
std::vector<int> garment_pieces(const Garment& garment);

/// Several garments in one, to be worn in layers: one solver steps them together, and with
/// self-contact on (SelfContactSettings) they keep off each other.
struct MergedGarments {
    Garment garment;                ///< vertices, faces, pins and goal limits garment by garment
    std::vector<int> first_vertex;  ///< of each, and at the end the number of all vertices
};

/// @throws ArgumentError if there is none, or they differ in fabric or in where their rest angles
///         come from: a Garment has one of each
MergedGarments merge_garments(const std::string& name, const std::vector<Garment>& garments);

}  // namespace cloth
