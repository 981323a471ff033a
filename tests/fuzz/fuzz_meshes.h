#pragma once

#include "data/core/garment.h"
#include "tests/fuzz/fuzz_random.h"

namespace cloth::test {

/// A surface of a few dozen faces: sheets, closed bodies, single triangles, several pieces, soups
/// of triangles; often with a defect (see fuzz_meshes.cpp), 1 mm to 1 km wide, anywhere.
TriMesh random_mesh(Random& random);

/// A flat sheet without defects: n x n vertices, 5 cm apart.
TriMesh plain_sheet(int n);

/// Within the ranges of Fabric, every magnitude as likely.
Fabric random_fabric(Random& random);

/// None, some or all of `count` vertices; now and then one that is not there.
std::vector<int> random_pins(Random& random, int count);

}  // namespace cloth::test
