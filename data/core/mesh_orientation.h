#pragma once

#include "data/core/types.h"

namespace cloth {

/// Faces of a surface that look to the wrong side. Face numbers are of one example each, -1: there
/// is none. Vertices of open edges at exactly the same place count as one, so that seams of files
/// are no borders.
struct OrientationFaults {
    int turned_edges = 0;      ///< whose two faces run through them in the same direction
    int turned_face = -1;      ///< the face with most of them
    int repeated_faces = 0;    ///< that stand there once more, turned round
    int repeated_face = -1;    ///< one of them
    int inside_out_face = -1;  ///< of a closed piece whose faces look inwards

    bool any() const { return turned_edges > 0 || repeated_faces > 0 || inside_out_face >= 0; }
};

/// What is wrong with the orientation of a surface. Open surfaces have no inside, and count as
/// closed where less than 5 % of their edges are open. A piece within the box of another one may be
/// its cavity, and one of less than a tenth of the volume is a detail: they are not judged.
/// @param x      vertices (|V| x 3, finite)
/// @param faces  |F| x 3, 0 to |V| - 1; those that name a vertex twice are passed over
OrientationFaults orientation_faults(const Points& x, const Faces& faces);

}  // namespace cloth
