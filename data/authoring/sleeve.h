#pragma once

#include "data/authoring/garment_recipe.h"
#include "data/core/mesh.h"

namespace cloth {

/// A round tube along the left upper arm, as wide as the widest part of the arm that it covers; a
/// sleeve past the elbow goes on along the forearm and narrows with it.
class Sleeve {
 public:
    Sleeve(const TriMesh& body, const BodyLandmarks& marks, const GarmentRecipe& recipe);

    /// Distance to the tube (m), negative inside.
    double operator()(const Vec3& p) const;

 private:
    struct Part {
        Vec3 from = Vec3::Zero(), axis = Vec3::Zero();
        double length = 0.0;
        double radius = 0.0, narrowing = 0.0;  ///< at `from`; less of it at the other end

        double operator()(const Vec3& p) const;
    };

    Part m_upper, m_fore;
    bool m_has_fore = false;
};

/// Where the left sleeve ends, and the direction of the arm there.
struct SleeveEnd {
    Vec3 point, direction;
};
SleeveEnd sleeve_end(const BodyLandmarks& marks, const GarmentRecipe& recipe);

}  // namespace cloth
