#include "data/authoring/make_garment.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "data/authoring/garment_cuts.h"
#include "data/authoring/garment_shape.h"
#include "data/authoring/mesh_quality.h"
#include "data/authoring/surface_edit.h"
#include "data/authoring/waistband.h"
#include "data/body/clearance.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr double kSmallestAngle = 20.2;  // of all triangles (degrees)

void check_result(const TriMesh& garment, const GarmentRecipe& recipe) {
    const int openings = (recipe.from == GarmentRecipe::From::shoulders ? 3 : 1) +
                         (recipe.to == GarmentRecipe::To::legs ? 2 : 1);
    const Topology shape = topology(garment.faces);
    if (!shape.manifold || !shape.oriented || shape.components != 1 ||
        shape.boundary_loops != openings || shape.euler_characteristic != 2 - openings)
        throw ArgumentError("GarmentRecipe",
                            "the cuts leave " + std::to_string(shape.boundary_loops) +
                                " openings instead of " + std::to_string(openings),
                            "check its landmarks, neck and hem against the body");
}

}  // namespace

AuthoredGarment make_garment(const TriMesh& body, const BodyLandmarks& landmarks,
                             const GarmentRecipe& recipe) {
    recipe.check();
    const BodyLandmarks marks = recipe.landmarks_on(landmarks);
    const TriMesh surface = cut_garment(garment_surface(body, marks, recipe), marks, recipe);
    check_result(surface, recipe);
    const SurfaceDistance skin(body);
    // The remesher leaves a thin triangle at times; with another number of vertices it does not.
    for (const double share : {1.0, 0.99, 1.01}) {
        TriMesh worn =
            remesh(surface, static_cast<int>(std::lround(share * recipe.target_vertices)));
        if (push_out(worn, skin, recipe.clearance) < recipe.clearance)
            throw ArgumentError("GarmentRecipe", "the garment cannot be kept outside the body",
                                "check its landmarks, or raise the eases");
        Points rest = worn.vertices;
        if (recipe.from == GarmentRecipe::From::waist)
            rest = without_stretch(worn.vertices, waist_height(marks, recipe), recipe);
        if (std::min(smallest_angle(worn), smallest_angle({rest, worn.faces})) > kSmallestAngle)
            return {worn, rest};
    }
    throw ArgumentError("GarmentRecipe.target_vertices",
                        "so many vertices leave triangles with angles below 20 degrees",
                        "give another number, or a band_ratio nearer to 1");
}

AuthoredGarment make_garment(const Body& body, const GarmentRecipe& recipe) {
    return make_garment(body.rest_mesh(), body_landmarks(body), recipe);
}

}  // namespace cloth
