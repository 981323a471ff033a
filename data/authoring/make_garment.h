#pragma once

#include "data/authoring/garment_recipe.h"
#include "data/core/mesh.h"

namespace cloth {

/// A garment on the body it was cut for, and what it would be without the body in it.
struct AuthoredGarment {
    TriMesh worn;
    Points rest;  ///< |V| x 3 (m): that of `worn`, but for the waistband, which is shorter
};

/// Cuts a garment for a body in its rest pose: one surface, open at neck or waist, arms and hems,
/// of irregular triangles with angles above 20 degrees. As worn it is outside the body by the
/// recipe's clearance at vertices, edge midpoints and face centres. Equal arguments give equal
/// bits.
///
/// The shape is the union of solids that cloth can take: a trunk and legs whose horizontal sections
/// are convex and hang straight over hollows, and round sleeves along the arms.
///
/// @param body       closed surface (m)
/// @param landmarks  of that body; those that the recipe has itself come before them
/// @throws ArgumentError if the recipe does not fit the body: no such garment can be cut
AuthoredGarment make_garment(const TriMesh& body, const BodyLandmarks& landmarks,
                             const GarmentRecipe& recipe);

/// For a body with joints.
///
///     const GarmentRecipe recipe = load_garment_recipe(asset_path("garments/pants.json"));
///     const AuthoredGarment pants = make_garment(Body::load_default(), recipe);
///
/// @throws ArgumentError as above
AuthoredGarment make_garment(const Body& body, const GarmentRecipe& recipe);

}  // namespace cloth
