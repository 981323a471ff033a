#pragma once

#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// A place in the body that follows its shape: a weighted mean of skin vertices.
struct RigPoint {
    std::string name;
    std::vector<int> vertices;
    std::vector<double> weights;  ///< |vertices|, sum 1

    Vec3 position(const Points& skin) const;
};

struct RigJoint {
    std::string name;
    int parent = -1;  ///< joint index, -1 for the root; parents come first
    int point = 0;    ///< index of the point that the joint turns about
};

/// A segment between two points, stiff with one joint.
struct RigBone {
    int joint = 0;
    int from = 0, to = 0;  ///< point indices
};

/// How a skin without skeleton is rigged (data/assets/body_rig.json says it for the default body).
struct RigRecipe {
    std::string model;      ///< mesh file, relative to the test models of assimp
    std::string mesh_name;  ///< the mesh in that file
    int vertex_count = 0;   ///< of the skin, as a check
    std::vector<RigPoint> points;
    std::vector<RigJoint> joints;
    std::vector<RigBone> bones;
};

/// Reads a recipe (JSON).
/// @throws LoadError naming the entry that is missing, malformed or refers to an unknown name
RigRecipe load_rig_recipe(const std::string& path);

}  // namespace cloth
