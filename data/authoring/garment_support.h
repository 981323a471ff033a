#pragma once

#include <string>
#include <vector>

#include "data/core/surface_distance.h"

namespace cloth {

/// What can keep a garment on a body, and what sort of garment it is.
struct GarmentSupport {
    enum class Kind {
        shoulders,  ///< it lies on skin that looks upwards
        waistband,  ///< its upper edge goes around the body: a band there can hold it
        pins        ///< nothing: vertices have to be fixed
    };
    Kind kind = Kind::pins;
    std::string sort;             ///< top, dress, suit, skirt, trousers, hat, shoes or piece
    std::vector<int> upper_edge;  ///< the loop of vertices of a waistband
    double pin_low = 0.0, pin_high = 0.0;  ///< heights (m) between which pins would hold it, if it
                                           ///< does not lie on shoulders
    double lying_share = 0.0;              ///< of its area that lies on skin that looks upwards
};

/// @param worn  manifold and oriented, outside of the skin
/// @param skin  standing, y up (m)
GarmentSupport find_support(const TriMesh& worn, const SurfaceDistance& skin);

/// "shoulders", "waistband" or "pins".
const char* name_of(GarmentSupport::Kind kind);

}  // namespace cloth
