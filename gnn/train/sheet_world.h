#pragma once

#include "data/authoring/sheet.h"
#include "gnn/train/scene_random.h"
#include "gnn/train/training_scene.h"

namespace cloth {

/// A sheet held in a random way (two corners, a side, all corners, one corner, nothing), its pins
/// swinging, and up to two spheres that move into it.
SceneParts make_sheet_parts(const TriMesh& flat, const Fabric& fabric, SceneRandom& random);

}  // namespace cloth
