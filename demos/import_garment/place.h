#pragma once

#include "demos/import_garment/options.h"

namespace cloth {

/// @param in_file  the garment's vertices as the file has them
/// @param garment  scaled, turned and moved as the options say (m)
/// @throws ArgumentError if the garment is not where the skin is, or lies beside it and would be
///         around it with another axis up; the message names the unit, the up axis and the move
///         that would fit. Who says which axis points up is believed
void check_place(const ImportOptions& options, const Points& in_file, const TriMesh& garment,
                 const TriMesh& skin);

}  // namespace cloth
