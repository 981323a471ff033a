#include "data/files/point_cache_writer.h"

#include "data/files/cache_format.h"

namespace cloth {

PointCacheWriter::PointCacheWriter(const std::string& path, Eigen::Index vertices,
                                   const CacheSettings& settings, CacheStart start, ByteOrder order)
    : CacheWriter(path, vertices, settings), m_order(order), m_file(unfinished_cache(path), start) {
}

void PointCacheWriter::write(int frame, const Points& x) {
    std::string bytes;
    bytes.reserve(static_cast<size_t>(x.size()) * sizeof(float));
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        for (Eigen::Index k = 0; k < 3; ++k)
            append_number(bytes, static_cast<float>(x(i, k)), m_order);
    m_file.write(bytes, "frame " + std::to_string(frame));
}

Pc2Writer::Pc2Writer(const std::string& path, Eigen::Index vertices, const CacheSettings& settings,
                     CacheStart start)
    : PointCacheWriter(path, vertices, settings, start, ByteOrder::little) {
    std::string header = std::string("POINTCACHE2") + '\0';
    append_number(header, std::int32_t{1}, ByteOrder::little);
    append_number(header, static_cast<std::int32_t>(vertices), ByteOrder::little);
    append_number(header, 0.0f, ByteOrder::little);
    append_number(header, 1.0f, ByteOrder::little);
    append_number(header, std::int32_t{settings.frames}, ByteOrder::little);
    write_header(header);
}

MddWriter::MddWriter(const std::string& path, Eigen::Index vertices, const CacheSettings& settings,
                     CacheStart start)
    : PointCacheWriter(path, vertices, settings, start, ByteOrder::big) {
    std::string header;
    append_number(header, std::int32_t{settings.frames}, ByteOrder::big);
    append_number(header, static_cast<std::int32_t>(vertices), ByteOrder::big);
    for (int frame = 0; frame < settings.frames; ++frame)
        append_number(header, static_cast<float>(frame / settings.rate), ByteOrder::big);
    write_header(header);
}

}  // namespace cloth
