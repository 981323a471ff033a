#pragma once

#include <string>

#include "data/core/mesh.h"
#include "data/files/point_cache_writer.h"

namespace cloth {

/// glTF 2.0 in one file (.glb): one mesh in metres, y up, as it is in the first frame, and a morph
/// target with places and normals for each of the others. An animation shows one target after the
/// other, in between a straight line. make_cache_writer() makes one.
///
/// A glTF file says at its beginning what follows, so until it is finished the frames are in a
/// point cache (PC2), which can be read at any time.
class GlbWriter : public CacheWriter {
 public:
    static constexpr int max_frames = 1000;  ///< weights grow with the square of their number

    /// @throws ArgumentError for more frames, or more bytes than the format can count (4 GiB)
    GlbWriter(const std::string& path, const TriMesh& mesh, const CacheSettings& settings,
              CacheStart start);

 private:
    void write(int, const Points& x) override { m_frames.add(x); }
    void commit() override;

    Faces m_faces;
    Pc2Writer m_frames;
};

}  // namespace cloth
