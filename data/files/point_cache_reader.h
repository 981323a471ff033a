#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "data/core/types.h"
#include "data/files/byte_order.h"

namespace cloth {

/// Reads a point cache, PC2 or MDD by the ending of its name, frame by frame.
///
///     PointCacheReader cache("shirt.pc2");
///     cache.check_vertices(mesh.vertices.rows());
///     for (int k = 0; k < cache.frames(); ++k) draw(cache.frame(k));
///
/// Of a cache whose writing was interrupted, or that was cut, the whole frames are there.
class PointCacheReader {
 public:
    /// @throws LoadError if there is no such file, its header is none, its counts cannot be right,
    ///         or not a single frame is whole; ArgumentError if its name has another ending
    explicit PointCacheReader(const std::string& path);

    int vertices() const { return m_vertices; }
    int frames() const { return m_frames; }               ///< that can be read
    int announced_frames() const { return m_announced; }  ///< that the header says
    /// What is missing, such as "12 of 90 frames are there"; empty: nothing is.
    std::string shortfall() const;

    /// When each frame is shown (s), of all that the header says. PC2 has none: empty.
    const std::vector<double>& times() const { return m_times; }

    /// @throws LoadError unless the cache is of a mesh with so many vertices
    void check_vertices(Eigen::Index expected) const;

    /// Places of the vertices (|V| x 3, m). @param k  from 0
    /// @throws ArgumentError if there is no such frame, LoadError if a number in it is not finite
    Points frame(int k);

 private:
    void read_pc2_header(std::uintmax_t size);
    void read_mdd_header(std::uintmax_t size);
    void count_frames(std::uintmax_t size);
    std::string read(std::uintmax_t begin, size_t count, const std::string& place);

    std::string m_path;
    std::ifstream m_file;
    ByteOrder m_order = ByteOrder::little;
    std::uintmax_t m_header = 0;  ///< bytes
    int m_vertices = 0, m_announced = 0, m_frames = 0;
    std::vector<double> m_times;
};

}  // namespace cloth
