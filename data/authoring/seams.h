#pragma once

#include "data/core/mesh.h"

namespace cloth {

/// Borders that lie along each other, but are not joined.
struct OpenSeams {
    double tolerance = 0.0;  ///< of a weld that joins them (m); 0: there are none
    int vertices = 0;        ///< that it would join
};

/// Finds seams that a weld of up to 5 mm would close, and that would not cost any face: the
/// smallest tolerance, of a few, that closes nearly as much as the largest one.
/// @param mesh  welded with a smaller tolerance; finite, with corners in range
OpenSeams find_open_seams(const TriMesh& mesh);

}  // namespace cloth
