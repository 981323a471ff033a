#pragma once

#include <string>
#include <vector>

#include "data/core/boundary.h"
#include "data/core/garment.h"

namespace cloth {

class Proximity;

/// What the colours of the cloth show.
enum class ColourMode { garments, stretch, contact };

/// A scale of colours for values from low to high, with what stands beside it.
struct ColourScale {
    struct Stop {
        double value;
        Vec3 colour;  ///< red, green, blue as shown, 0 to 1
        std::string label;
    };
    std::vector<Stop> stops;  ///< rising

    Vec3 colour(double value) const;  ///< the nearest end's beyond the ends
};

/// Length of an edge over its rest length: blue is slack, red is stretched.
const ColourScale& stretch_scale();
/// Distance to the nearest obstacle (m): magenta is inside.
const ColourScale& contact_scale();

/// Mean stretch of the edges at each vertex (|V|); 1 where there is none.
VectorX vertex_stretch(const Garment& garment, const Points& x);

/// |V| x 3, red, green and blue; empty for ColourMode::garments.
/// @param boundary  of the step that ended at x (|V| x 3, m)
Points vertex_colours(ColourMode mode, const Garment& garment, const Points& x,
                      const Boundary& boundary, Proximity& proximity);

}  // namespace cloth
