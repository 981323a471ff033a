#pragma once

#include <cstddef>

class btCollisionShape;

namespace cloth {

/// A number that changes when the shape of an object is replaced, rescaled or, as far as it can be
/// told cheaply, changed: its box and margin, children of compounds and their places, counts,
/// buffers and evenly spread samples of the vertices and triangles of meshes and hulls.
///
/// It is asked for every object near cloth in every world step, so it looks at 16 vertices and 16
/// triangles of each part of a mesh. A mesh costs 1 us, or 8 where nothing of it is in the caches;
/// primitives, hulls and each child of a compound 0.1 us. A vertex that is moved within the box of
/// its mesh, and is not among those, is not seen: give the object another shape then, or use an
/// animated obstacle.
size_t shapeSignature(const btCollisionShape& shape);

}  // namespace cloth
