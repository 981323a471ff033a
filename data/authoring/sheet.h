#pragma once

#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// A flat rectangle of irregular triangles in the plane y = 0, centred at the origin, normal +y.
///
///     TriMesh sheet = make_sheet(1.0, 1.0, 900);
///     Garment cloth("sheet", sheet, Fabric::soft_cotton(), sheet_corners(sheet));
///
/// Random points, moved until their Delaunay triangles are well shaped (Alliez et al. 2005): mean
/// degree near 6, every angle above 20 degrees. Equal arguments give equal bits.
///
/// @param width            size along x (m)
/// @param depth            size along z (m), at most 20 times as long or short as the width
/// @param target_vertices  vertices of the sheet, 9 to 200,000; met within 3 %, mostly exactly
/// @param seed             another seed gives another triangulation
/// @throws ArgumentError if an argument is out of range, or so few vertices cannot fill the shape
/// well
TriMesh make_sheet(double width, double depth, int target_vertices, unsigned seed = 1);

/// Side of a sheet, seen with +x to the right and +z towards the viewer.
enum class SheetSide { left, right, back, front };

/// The four corners: (-x, -z), (+x, -z), (-x, +z), (+x, +z).
std::vector<int> sheet_corners(const TriMesh& sheet);

/// All vertices of one side, corners included, in ascending order along it.
std::vector<int> sheet_side(const TriMesh& sheet, SheetSide side);

}  // namespace cloth
