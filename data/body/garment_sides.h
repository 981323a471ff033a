#pragma once

#include <optional>
#include <vector>

#include "data/core/surface_distance.h"

namespace cloth {

/// How far each face looks away from the skin (|F|): the cosine between its normal and the way from
/// the nearest point of the skin to its middle. 1: outwards; -1: at the skin.
VectorX outwardness(const TriMesh& garment, const SurfaceDistance& skin);

/// Turns whole pieces of a garment so that their faces look away from the skin; closed pieces, so
/// that they enclose a positive volume.
/// @param garment  consistently oriented, see repair_mesh()
/// @return number of pieces that were turned
int turn_outwards(TriMesh& garment, const SurfaceDistance& skin);

/// The faces of a garment that is modelled with a thickness that lie on its inside, towards the
/// skin.
struct InnerSide {
    std::vector<char> is_inner;  ///< |F|
    double share = 0.0;          ///< of the garment's area
    double thickness = 0.0;      ///< median distance to the outer side (m)
};

/// Finds the inner side of a shell, such as a modeller's "solidify" makes: faces that look at the
/// skin, most of which have the other side of the same piece 20 mm away or less. The rim between
/// the sides counts as inner.
/// @param garment  turned outwards
/// @return nothing if it is one layer
std::optional<InnerSide> find_inner_side(const TriMesh& garment, const SurfaceDistance& skin);

/// A piece of a garment that lies under another one everywhere, as a lining does.
struct Lining {
    int piece = 0, below = 0;  ///< numbers of face_pieces()
    double gap = 0.0;          ///< median distance (m)
};

/// Pairs of pieces of which nearly all is within 15 mm of the other one.
/// @param garment  turned outwards
std::vector<Lining> find_linings(const TriMesh& garment, const std::vector<int>& face_pieces,
                                 const SurfaceDistance& skin);

}  // namespace cloth
