#pragma once

#include "data/authoring/garment_import.h"
#include "render/image.h"

namespace cloth {

/// The garment as it was read and as it is worn, each from the front and from behind.
/// @throws LoadError if OSMesa or the font is missing
Image import_picture(const GarmentImport& import, const TriMesh& skin);

}  // namespace cloth
