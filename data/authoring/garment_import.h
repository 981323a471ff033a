#pragma once

#include <string>
#include <vector>

#include "data/authoring/garment_support.h"
#include "data/core/mesh.h"

namespace cloth {

struct GarmentImportSettings {
    double weld = 1e-4;         ///< vertices as near as this become one (m), 0 to 0.01
    double clearance = 4.5e-3;  ///< from skin to cloth (m), 1e-3 to 0.05
    double most_inside =
        0.5;  ///< part of a piece's vertices that may start inside the skin, 0 to 1
    double smallest_piece = 0.03;  ///< part of the area; smaller pieces are left out, 0 to 1
    int vertices = 0;              ///< of each garment, remeshed: 500 to 60,000; 0: as they come
    double band_width = 0.04;      ///< of a waistband (m), 0.02 to 0.1
    double band_ratio = 0.7;       ///< its length at rest by that worn, 0.5 to 1; 1: no waistband
    bool together = false;         ///< pieces that do not touch are one garment all the same
    std::string garment_name = "garment";  ///< what messages call it: its file
    std::string skin_name = "character";   ///< the same of the skin

    /// @throws ArgumentError naming the field that is out of range
    void check() const;
};

/// One garment as a body wears it.
struct ImportedGarment {
    TriMesh worn;
    Points rest;             ///< |V| x 3 (m): that of `worn`, but for a waistband, which is shorter
    GarmentSupport support;  ///< of all; vertices of all waistbands
    std::vector<GarmentSupport> piece_support;  ///< of each connected piece

    int vertices_before = 0;    ///< after welding and mending, before remeshing
    double angle_before = 0.0;  ///< smallest one of all faces (degrees)
    double angle = 0.0;
    double inside_before = 0.0;                  ///< part of the vertices inside the skin
    double deepest_before = 0.0;                 ///< (m), 0 or more
    double inside = 0.0;                         ///< as worn
    double clearance = 0.0;                      ///< smallest distance to the skin as worn (m)
    double strain_low = 0.0, strain_high = 0.0;  ///< of 1 % and 99 % of the edges: what being led
                                                 ///< out of the skin did to their lengths
    double rest_strain = 0.0;                    ///< of the edge that a waistband makes shortest,
                                                 ///< rest by worn: 0 without one, or negative
    double edge_length = 0.0;                    ///< mean, as worn (m)
};

/// What was made of somebody's mesh.
struct GarmentImport {
    TriMesh read;                           ///< before anything was changed
    std::vector<ImportedGarment> garments;  ///< pieces, largest area first
    double clearance = 0.0;             ///< that the skin left room for (m): the setting, or less
    std::vector<std::string> changes;   ///< what was done, a sentence each
    std::vector<std::string> warnings;  ///< what may go wrong, and the remedy
};

/// Makes garments that can be simulated of a mesh that was modelled around a body: welds, mends and
/// orients it, leaves out inner sides, linings and small pieces, leads what is inside out of the
/// skin, remeshes on request, and finds what can hold each garment.
///
///     const GarmentImport import = import_garment(load_mesh("skirt.obj"), body.rest_mesh());
///     save_obj("skirt.obj", {import.garments[0].rest, import.garments[0].worn.faces});
///
/// @param mesh  (m, y up), see is_in_place()
/// @param skin  closed, faces outwards, in the pose that the mesh was modelled on (m)
/// @throws ArgumentError saying what is wrong and the remedy: settings out of range, a mesh without
///         faces or with a vertex that is not finite, edges that cannot be mended, a one-sided
///         piece, a skin that is inside out, a garment that is 0.3 m from the skin, most of which
///         is inside it, that cannot be led out of it, or only by stretching it to twice its size
GarmentImport import_garment(const TriMesh& mesh, const TriMesh& skin,
                             const GarmentImportSettings& settings = {});

/// Which of two garments lies over the other, where they are near each other (m): the mean of how
/// much farther from the skin `a` is. 0: they do not overlap.
double height_over(const TriMesh& a, const TriMesh& b, const SurfaceDistance& skin);

}  // namespace cloth
