#pragma once

#include <string>

#include "data/files/byte_order.h"
#include "data/files/cache_writer.h"

namespace cloth {

/// A point cache: a header, and for each frame three floats for each vertex. Neither format has
/// faces. make_cache_writer() makes them.
class PointCacheWriter : public CacheWriter {
 protected:
    PointCacheWriter(const std::string& path, Eigen::Index vertices, const CacheSettings& settings,
                     CacheStart start, ByteOrder order);

    void write_header(const std::string& header) { m_file.write(header, "header"); }

 private:
    void write(int frame, const Points& x) override;
    void commit() override { m_file.commit(path()); }

    ByteOrder m_order;
    ResumedFile m_file;
};

/// PC2: little-endian. The header, 32 bytes: "POINTCACHE2" and a zero byte; version 1; vertices;
/// start frame 0 and a sample for each frame, as floats; samples.
class Pc2Writer : public PointCacheWriter {
 public:
    Pc2Writer(const std::string& path, Eigen::Index vertices, const CacheSettings& settings,
              CacheStart start);
};

/// MDD: big-endian. The header: frames, vertices, and a float for each frame, its time (s).
class MddWriter : public PointCacheWriter {
 public:
    MddWriter(const std::string& path, Eigen::Index vertices, const CacheSettings& settings,
              CacheStart start);
};

}  // namespace cloth
