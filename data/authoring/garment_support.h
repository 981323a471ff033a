#pragma once

#include <string>
#include <vector>

#include "data/core/surface_distance.h"

namespace cloth {

/// What can keep a garment on a body, and what sort of garment it is.
struct GarmentSupport {
    enum class Kind {
        shoulders,  ///< it lies, or comes to lie when it falls, on skin that looks upwards
        waistband,  ///< its upper edge goes around the trunk: a band there can hold it
        pins        ///< nothing: vertices have to be fixed
    };
    Kind kind = Kind::pins;
    /// top, dress, suit, skirt, trousers, wrap (a scarf, a poncho), hat, shoes or piece
    std::string sort;
    std::vector<int> upper_edge;  ///< the loop of vertices of a waistband
    double edge_length = 0.0;     ///< of that loop, as worn (m)
    double waist_girth = 0.0;     ///< of the body within that loop (m), 0: none was found there
    double pin_low = 0.0, pin_high = 0.0;  ///< heights (m) between which pins would hold it, if it
                                           ///< does not lie on shoulders
    double pinned_share = 0.0;             ///< part of its vertices between these heights
    double lying_share = 0.0;              ///< of its area that lies on skin that looks upwards
    double landing_area = 0.0;             ///< that would come to lie there if it fell (m^2)

    /// Whether pins between these heights leave most of it free.
    bool can_be_pinned() const { return kind != Kind::shoulders && pinned_share <= 1.0 / 3.0; }
};

/// @param worn  one connected piece, manifold and oriented, outside of the skin
/// @param skin  standing, y up (m)
GarmentSupport find_support(const TriMesh& worn, const SurfaceDistance& skin);

/// What can be said of a garment of several pieces: it is held as the piece that is held least.
/// @param pieces  not empty
GarmentSupport support_of_all(const std::vector<GarmentSupport>& pieces);

/// Whether it is a tube, such as a skirt, whose two largest openings look sideways. (Those of
/// sleeves do, too, but the hem is larger.)
/// @param mesh  manifold and oriented
bool lies_on_its_side(const TriMesh& mesh);

/// The part of the vertices between the heights of the pins.
double share_between(const Points& x, const GarmentSupport& support);

/// "shoulders", "waistband" or "pins".
const char* name_of(GarmentSupport::Kind kind);

}  // namespace cloth
