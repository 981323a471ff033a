#pragma once

#include "data/core/types.h"

namespace cloth {

/// Whether there are faces, and all their corners are among the vertices.
inline bool faces_in_range(const Faces& faces, Eigen::Index vertex_count) {
    return faces.rows() > 0 && faces.minCoeff() >= 0 && faces.maxCoeff() < vertex_count;
}

}  // namespace cloth
