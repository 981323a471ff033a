#pragma once

#include <optional>
#include <string>

#include "data/files/cache_writer.h"
#include "data/files/write_lock.h"

namespace cloth {

/// A folder NAME with NAME_0001.obj, NAME_0002.obj and so on, each of which appears whole or not
/// at all. make_cache_writer() makes one.
class ObjSequence : public CacheWriter {
 public:
    /// @throws LoadError if the folder cannot be made or, unless it goes on, has a sequence of this
    ///         name: files of a longer one would be left at its end; or if another run writes to it
    ObjSequence(const std::string& path, const TriMesh& mesh, const CacheSettings& settings,
                CacheStart start);

    /// Of a frame from 0.
    std::string file(int frame) const;

 private:
    void write(int frame, const Points& x) override;
    void commit() override {}

    std::string m_prefix;
    std::optional<WriteLock> m_lock;  ///< of the folder
    TriMesh m_mesh;
};

}  // namespace cloth
