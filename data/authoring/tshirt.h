#pragma once

#include <string>

#include "data/core/mesh.h"

namespace cloth {

/// How a short-sleeved T-shirt is cut for one body. The body stands upright (y up) and faces +z,
/// its left side is +x; what is given for the left arm holds, mirrored, for the right one.
///
///     TshirtRecipe recipe = load_tshirt_recipe(asset_path("garments/tshirt.json"));
///     TriMesh shirt = make_tshirt(body_rest, recipe);
///
/// The defaults are those of data/assets/garments/tshirt.json: a regular fit for the default body.
struct TshirtRecipe {
    int target_vertices = 4000;  ///< met within 3 %, 500 to 20,000

    // Where the body is (m, each coordinate -5 to 5): rest pose of the default body, 1.66 m tall,
    // arms 50 degrees down.
    Vec3 shoulder = Vec3(0.158, 1.325, 0.012);  ///< centre of the left shoulder joint
    Vec3 elbow = Vec3(0.335, 1.130, 0.026);     ///< centre of the left elbow
    Vec3 armpit = Vec3(0.168, 1.245, 0.010);    ///< top of the fold between left arm and chest
    Vec3 neck = Vec3(0.0, 1.383, 0.0242);       ///< centre of the neck opening

    double neck_tilt = 29.0;         ///< how far the opening leans forward (degrees), 0 to 60
    double neck_half_width = 0.078;  ///< of the opening, left to right (m), 0.05 to 0.15
    double neck_half_depth = 0.070;  ///< of the opening, front to back (m), 0.05 to 0.15
    double sleeve_length = 0.55;  ///< end of the sleeve along the upper arm, 0 shoulder to 1 elbow,
                                  ///< 0.3 to 0.8
    double hem_height = 0.81;     ///< height of the hem above the ground (m), 0.3 to 1.5

    double chest_ease = 0.014;  ///< from the hull of the torso to the cloth (m), 0.008 to 0.05
    double sleeve_ease =
        0.012;  ///< from the widest part of the arm to the cloth (m), 0.008 to 0.05
    double drape_radius =
        0.6;  ///< hollows of the waist curved more than this are bridged (m), 0.3 to 10
    double clearance =
        0.0045;  ///< the cloth is nowhere nearer to the body than this (m), 0.001 to 0.01
};

/// @throws LoadError if the file is missing, is not JSON, or has a field that is unknown, of the
///         wrong type or out of range
TshirtRecipe load_tshirt_recipe(const std::string& path);

/// Cuts a T-shirt for a body in its rest pose: one surface, open at neck, hem and both sleeves, of
/// irregular triangles with angles above 20 degrees, outside the body by the recipe's clearance at
/// vertices, edge midpoints and face centres. Equal arguments give equal bits.
///
/// The shape is the union of two solids that cloth can take: a torso whose horizontal sections are
/// convex and hang straight over the waist, and round sleeves along the upper arms.
///
/// @throws ArgumentError if the recipe does not fit the body: no such T-shirt can be cut
TriMesh make_tshirt(const TriMesh& body_rest, const TshirtRecipe& recipe = {});

}  // namespace cloth
