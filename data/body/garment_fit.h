#pragma once

#include <string>

#include "data/core/mesh.h"

namespace cloth {

struct GarmentFitSettings {
    double clearance = 0.0045;  ///< the cloth is nowhere nearer to the new body than this (m),
                                ///< 1e-4 to 0.05
    int smoothing = 40;         ///< rounds of averaging the displacement over the cloth, 0 to 500
    std::string garment_name = "fit_garment: garment_rest";  ///< what messages call it
};

/// Carries a garment from one body shape to another: every vertex moves as the nearest point of the
/// skin does, evened out over the cloth, and then as far outwards as the clearance asks for.
///
///     Points shirt = fit_garment(garment.rest(), body.rest_mesh(), shapes.skin(shape));
///
/// @param garment_rest  the garment on `body_from` (|V| x 3, m)
/// @param body_from     closed body surface in its rest pose (m)
/// @param body_to       the same body's vertices in the other shape and the same pose (m)
/// @return positions of the garment on `body_to` (|V| x 3, m), clear of it at vertices, edge
///         midpoints and face centres
/// @throws ArgumentError if `body_to` has another number of vertices or is not finite, or if the
///         garment cannot be kept clear of it
Points fit_garment(const TriMesh& garment_rest, const TriMesh& body_from, const Points& body_to,
                   const GarmentFitSettings& settings = {});

}  // namespace cloth
