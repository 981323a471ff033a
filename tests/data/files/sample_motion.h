#pragma once

#include "data/core/mesh.h"
#include "data/files/cache_writer.h"

namespace cloth::test {

/// Two triangles.
inline TriMesh sample_mesh() {
    TriMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.25;
    mesh.faces.resize(2, 3);
    mesh.faces << 0, 1, 2, 0, 2, 3;
    return mesh;
}

/// Where its vertices are in a frame; floats have these numbers exactly.
inline Points sample_frame(int frame) {
    return sample_mesh().vertices.array() + 0.5 * frame;
}

/// Adds frames up to, and without, `end`.
inline void add_frames(CacheWriter& cache, int end) {
    while (cache.frames() < end) cache.add(sample_frame(cache.frames()));
}

/// Writes a whole cache.
inline void write_cache(const std::string& path, int frames, double rate = 30.0) {
    const auto cache = make_cache_writer(path, sample_mesh(), {rate, frames});
    add_frames(*cache, frames);
    cache->finish();
}

}  // namespace cloth::test
