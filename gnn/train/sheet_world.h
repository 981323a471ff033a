#pragma once

#include "data/authoring/sheet.h"
#include "gnn/train/scene_random.h"
#include "gnn/train/training_scene.h"

namespace cloth {

/// A sheet held in a random way (two corners, a side, all corners, one corner, nothing), its pins
/// swinging, and up to two spheres that move into it.
SceneParts make_sheet_parts(const TriMesh& flat, const Fabric& fabric, SceneRandom& random);

/// A sheet of soft cotton, 60 by 60 cm and level, that starts at rest: held by two corners it falls
/// and swings, or it drops onto a sphere. The same for every training.
/// @param vertices  9 to 200,000
SceneParts make_test_sheet(int vertices, bool held);

}  // namespace cloth
