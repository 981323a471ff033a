#pragma once

#include <memory>

#include "render/scene.h"

namespace cloth {

/// The skin of a body, as films and pictures show it. @param x  |V| x 3 (m)
SceneMesh skin_mesh(const Points& x, std::shared_ptr<const Faces> faces);

/// A garment, seen from both sides. @param x  |V| x 3 (m)
/// @param index  of the panel or row: each has a colour of its own, and colours repeat
SceneMesh garment_mesh(const Points& x, std::shared_ptr<const Faces> faces, size_t index);

}  // namespace cloth
