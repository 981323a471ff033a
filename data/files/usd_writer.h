#pragma once

#include <string>

#include "data/files/cache_writer.h"

namespace cloth {

/// Universal Scene Description as text (.usda): one mesh in metres, y up, whose points have a
/// sample for each frame. Time codes are frames, from 0. Its name is that of the file.
/// make_cache_writer() makes one. The brackets are closed after every frame, so that an interrupted
/// file can be opened.
class UsdWriter : public CacheWriter {
 public:
    UsdWriter(const std::string& path, const TriMesh& mesh, const CacheSettings& settings,
              CacheStart start);

 private:
    void write(int frame, const Points& x) override;
    void commit() override { m_file.commit(path()); }

    ResumedFile m_file;
};

}  // namespace cloth
