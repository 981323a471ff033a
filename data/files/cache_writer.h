#pragma once

#include <memory>
#include <string>

#include "data/core/mesh.h"
#include "data/files/resumed_file.h"

namespace cloth {

/// What is known of a cache before its first frame.
struct CacheSettings {
    double rate = 30.0;  ///< frames per second, 1 to 1000
    int frames = 1;      ///< that will be written, 1 to 1e6: headers say so

    /// @throws ArgumentError if a field is out of range
    void check() const;
};

/// Writes a mesh in motion, frame by frame: none is kept in memory.
///
///     const auto cache = make_cache_writer("shirt.pc2", garment.rest(), {30.0, 90});
///     for (int frame = 0; frame < 90; ++frame) cache->add(positions(frame));
///     cache->finish();
///
/// Until it is finished a file is called unfinished_cache(), can be read up to its last whole
/// frame, and stays where writing is interrupted.
class CacheWriter {
 public:
    virtual ~CacheWriter() = default;
    CacheWriter(const CacheWriter&) = delete;
    CacheWriter& operator=(const CacheWriter&) = delete;

    /// The next frame.
    /// @param x  |V| x 3 (m); files have it in single precision, OBJ in double
    /// @throws ArgumentError if the number of vertices is not that of the mesh, a coordinate is not
    ///         finite or is beyond single precision, or all frames are there; LoadError if the disk
    ///         is full, or the frame is there from an earlier run and differs
    void add(const Points& x);

    /// Gives the cache its name. @throws ArgumentError if a frame is missing, LoadError
    void finish();

    const std::string& path() const { return m_path; }  ///< when it is finished
    int frames() const { return m_frames; }             ///< so far

 protected:
    CacheWriter(std::string path, Eigen::Index vertices, const CacheSettings& settings);

    const CacheSettings& settings() const { return m_settings; }

 private:
    virtual void write(int frame, const Points& x) = 0;
    virtual void commit() = 0;

    std::string m_path;
    Eigen::Index m_vertices;
    CacheSettings m_settings;
    int m_frames = 0;
};

/// A writer of the format that the ending of the path says, see cache_format().
///
/// @param mesh   USD, glTF and OBJ have its faces, USD its vertices as the mesh at rest; point
/// caches
///               belong to a mesh file with the same order of vertices, such as save_obj() writes
/// @param start  go_on: frames that an earlier, interrupted run has left are added again, from
///               the first one, and are compared
/// @throws ArgumentError for an unknown ending, a mesh without vertices, settings out of range;
///         LoadError if the file cannot be written
std::unique_ptr<CacheWriter> make_cache_writer(const std::string& path, const TriMesh& mesh,
                                               const CacheSettings& settings,
                                               CacheStart start = CacheStart::anew);

}  // namespace cloth
