#pragma once

#include <zip.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace cloth::test {

/// The bytes of a .npy file. @param descr, order  as they stand in its header
inline std::string npy(const std::string& descr, const std::vector<std::int64_t>& shape,
                       const std::string& data, bool fortran = false) {
    std::string extents;
    for (const std::int64_t extent : shape) extents += std::to_string(extent) + ", ";
    if (shape.size() > 1) extents.resize(extents.size() - 2);
    if (shape.size() == 1) extents.pop_back();
    std::string header = "{'descr': '" + descr +
                         "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" +
                         extents + "), }";
    while ((10 + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
    std::string bytes = "\x93NUMPY";
    bytes += '\1';
    bytes += '\0';
    bytes += static_cast<char>(header.size() & 255);
    bytes += static_cast<char>(header.size() >> 8);
    return bytes + header + data;
}

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

inline std::string npy(const std::vector<std::int64_t>& shape, const std::vector<double>& numbers) {
    return npy("<f8", shape, bytes_of(numbers));
}
inline std::string npy(const std::vector<std::int64_t>& shape, const std::vector<float>& numbers) {
    return npy("<f4", shape, bytes_of(numbers));
}
inline std::string npy(const std::vector<std::int64_t>& shape,
                       const std::vector<std::uint32_t>& numbers) {
    return npy("<u4", shape, bytes_of(numbers));
}
inline std::string npy(const std::vector<std::int64_t>& shape,
                       const std::vector<std::int32_t>& numbers) {
    return npy("<i4", shape, bytes_of(numbers));
}

/// Writes arrays, given as .npy files, as numpy.savez_compressed does, or as numpy.savez.
inline void write_npz(const std::string& path, const std::map<std::string, std::string>& arrays,
                      bool compressed = true) {
    const zipFile archive = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
    if (!archive) throw std::runtime_error(path + ": cannot be written");
    for (const auto& [name, bytes] : arrays) {
        const zip_fileinfo info{};
        zipOpenNewFileInZip(archive, (name + ".npy").c_str(), &info, nullptr, 0, nullptr, 0,
                            nullptr, compressed ? Z_DEFLATED : 0, Z_DEFAULT_COMPRESSION);
        zipWriteInFileInZip(archive, bytes.data(), static_cast<unsigned>(bytes.size()));
        zipCloseFileInZip(archive);
    }
    zipClose(archive, nullptr);
}

}  // namespace cloth::test
