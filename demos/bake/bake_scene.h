#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "demos/bake/scene_options.h"
#include "demos/compare/comparison_scene.h"

namespace cloth {

/// What is baked: a garment's scene, and the body in it.
struct BakeScene {
    std::shared_ptr<const ComparisonScene> cloth;
    TriMesh body;                        ///< before any motion
    std::function<Points(double)> skin;  ///< its vertices at a time of the scene's clock (s)
    std::vector<Faces> parts;        ///< faces of each garment, numbered as all its vertices are
    std::vector<std::string> notes;  ///< what is to be told of the files, a sentence each

    int frames() const { return cloth->frames() + 1; }  ///< the first pose, and one for each step
};

/// @throws LoadError, ArgumentError, UsageError if garment, body or motion cannot be had
BakeScene make_bake_scene(const SceneOptions& options);

}  // namespace cloth
