#include "data/files/point_cache_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "data/core/errors.h"
#include "data/files/cache_format.h"

namespace cloth {
namespace {

const char* const bake_again = "it is damaged, or was cut before its first frame: write it again";

std::uintmax_t size_of_file(const std::string& path) {
    std::error_code error;
    const bool is_folder = std::filesystem::is_directory(path, error);
    if (is_folder) throw LoadError(path, "", "is a folder", "give the path of a file");
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw LoadError(path, "", "cannot be opened", "check path and permissions");
    return size;
}

}  // namespace

PointCacheReader::PointCacheReader(const std::string& path) : m_path(path) {
    const CacheFormat format = cache_format(path);
    const std::uintmax_t size = size_of_file(path);
    m_file.open(path, std::ios::binary);
    if (!m_file) throw LoadError(path, "", "cannot be opened", "check path and permissions");
    if (format == CacheFormat::pc2)
        read_pc2_header(size);
    else if (format == CacheFormat::mdd)
        read_mdd_header(size);
    else
        throw ArgumentError(path, "is no point cache", "give a .pc2 or .mdd file");
    count_frames(size);
}

std::string PointCacheReader::read(std::uintmax_t begin, size_t count, const std::string& place) {
    std::string bytes(count, '\0');
    m_file.clear();
    m_file.seekg(static_cast<std::streamoff>(begin));
    m_file.read(bytes.data(), static_cast<std::streamsize>(count));
    if (!m_file) throw LoadError(m_path, place, "the file ends too early", bake_again);
    return bytes;
}

void PointCacheReader::read_pc2_header(std::uintmax_t size) {
    m_order = ByteOrder::little;
    m_header = 32;
    if (size < m_header) throw LoadError(m_path, "header", "the file ends too early", bake_again);
    const std::string header = read(0, 32, "header");
    if (header.compare(0, 12, std::string("POINTCACHE2") + '\0') != 0)
        throw LoadError(m_path, "header", "it does not begin with POINTCACHE2",
                        "give a PC2 file; a Lightwave cache has a name that ends with .mdd");
    const auto version = number_at<std::int32_t>(&header[12], m_order);
    if (version != 1)
        throw LoadError(m_path, "header", "its version is " + std::to_string(version) + ", not 1",
                        "export it as version 1");
    m_vertices = number_at<std::int32_t>(&header[16], m_order);
    m_announced = number_at<std::int32_t>(&header[28], m_order);
}

void PointCacheReader::read_mdd_header(std::uintmax_t size) {
    m_order = ByteOrder::big;
    const std::string counts = read(0, 8, "header");
    m_announced = number_at<std::int32_t>(counts.data(), m_order);
    m_vertices = number_at<std::int32_t>(&counts[4], m_order);
    const auto times = static_cast<std::uintmax_t>(std::max(0, m_announced)) * 4;
    m_header = 8 + times;
    if (size < m_header)
        throw LoadError(
            m_path, "header",
            "the file is too short for the times of " + std::to_string(m_announced) + " frames",
            "give an MDD file, whole or with its header at least");
    const std::string bytes = read(8, static_cast<size_t>(times), "header");
    for (size_t at = 0; at < bytes.size(); at += 4) {
        const auto time = static_cast<double>(number_at<float>(&bytes[at], m_order));
        if (!std::isfinite(time))
            throw LoadError(m_path, "header, frame " + std::to_string(at / 4),
                            "its time is not finite", bake_again);
        m_times.push_back(time);
    }
}

void PointCacheReader::count_frames(std::uintmax_t size) {
    if (m_vertices < 1 || m_announced < 1)
        throw LoadError(m_path, "header",
                        "it says " + std::to_string(m_announced) + " frames of " +
                            std::to_string(m_vertices) + " vertices",
                        bake_again);
    const std::uintmax_t whole = (size - m_header) / (static_cast<std::uintmax_t>(m_vertices) * 12);
    m_frames =
        static_cast<int>(std::min<std::uintmax_t>(whole, static_cast<unsigned>(m_announced)));
    if (m_frames == 0)
        throw LoadError(m_path, "",
                        "it has no whole frame of " + std::to_string(m_vertices) + " vertices",
                        bake_again);
}

std::string PointCacheReader::shortfall() const {
    if (m_frames == m_announced) return {};
    return std::to_string(m_frames) + " of " + std::to_string(m_announced) + " frames are there";
}

void PointCacheReader::check_vertices(Eigen::Index expected) const {
    if (m_vertices != expected)
        throw LoadError(m_path, "",
                        "it has " + std::to_string(m_vertices) + " vertices, the mesh " +
                            std::to_string(expected),
                        "give the cache together with the mesh that was written with it");
}

Points PointCacheReader::frame(int k) {
    if (k < 0 || k >= m_frames)
        throw ArgumentError(m_path + ", frame " + std::to_string(k), "there is none",
                            "give a frame from 0 to " + std::to_string(m_frames - 1));
    const std::string place = "frame " + std::to_string(k);
    const size_t count = static_cast<size_t>(m_vertices) * 12;
    const std::string bytes = read(m_header + static_cast<std::uintmax_t>(k) * count, count, place);
    Points x(m_vertices, 3);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        x.data()[i] =
            static_cast<double>(number_at<float>(&bytes[4 * static_cast<size_t>(i)], m_order));
        if (!std::isfinite(x.data()[i]))
            throw LoadError(m_path, place + ", vertex " + std::to_string(i / 3),
                            "its position is not finite", "write the cache again");
    }
    return x;
}

}  // namespace cloth
