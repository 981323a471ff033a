#include "data/files/ply_layout.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <sstream>

#include "data/core/errors.h"
#include "data/core/printable.h"

namespace cloth {

namespace {

int bytes_of(const std::string& type) {
    if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
    if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
    if (type == "double" || type == "float64") return 8;
    return 4;
}

void check_elements(const std::string& path, const PlyLayout& layout) {
    for (const PlyElement& element : layout.elements)
        if (element.count < 0 || (element.count > 0 && element.properties.empty()))
            throw LoadError(path, "header, element " + printable(element.name),
                            "it has a negative number of rows, or rows without properties",
                            "export the mesh again");
}

PlyProperty read_property(std::istringstream& line) {
    PlyProperty property;
    line >> property.type;
    if (property.type == "list") {
        std::string count_type;
        line >> count_type >> property.type;
        property.count_bytes = bytes_of(count_type);
    }
    property.bytes = bytes_of(property.type);
    line >> property.name;
    return property;
}

/// The number that these bits are, its last byte the lowest.
template <typename Number, typename Bits>
double number_of(std::uint64_t bits) {
    static_assert(sizeof(Number) == sizeof(Bits), "the same bytes");
    const auto low = static_cast<Bits>(bits);
    Number number;
    std::memcpy(&number, &low, sizeof number);
    return static_cast<double>(number);
}

double value_of(const std::string& type, int bytes, std::uint64_t bits) {
    const bool is_unsigned = type[0] == 'u';
    if (bytes == 8) return number_of<double, std::uint64_t>(bits);
    if (is_unsigned) return static_cast<double>(bits);
    if (bytes == 1) return number_of<std::int8_t, std::uint8_t>(bits);
    if (bytes == 2) return number_of<std::int16_t, std::uint16_t>(bits);
    return type[0] == 'i' ? number_of<std::int32_t, std::uint32_t>(bits)
                          : number_of<float, std::uint32_t>(bits);
}

}  // namespace

PlyLayout read_ply_layout(const std::string& path, const std::string& text) {
    PlyLayout layout;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        std::istringstream line(text.substr(at, end - at));
        at = end + 1;
        std::string word, type;
        line >> word;
        if (word == "format") {
            line >> type;
            layout.format = type == "ascii"                  ? PlyFormat::ascii
                            : type == "binary_little_endian" ? PlyFormat::little_endian
                                                             : PlyFormat::big_endian;
        } else if (word == "element") {
            layout.elements.emplace_back();
            line >> layout.elements.back().name >> layout.elements.back().count;
        } else if (word == "property" && !layout.elements.empty()) {
            layout.elements.back().properties.push_back(read_property(line));
        } else if (word == "end_header") {
            layout.data = std::min(at, text.size());
            check_elements(path, layout);
            return layout;
        }
    }
    throw LoadError(path, "header", "it does not end with end_header",
                    "the file is truncated: export or download it again");
}

bool PlyCursor::skip(const PlyProperty& property) {
    long values = 1;
    if (property.count_bytes > 0 && !read_count(property.count_bytes, values)) return false;
    if (values < 0) return false;
    if (m_format != PlyFormat::ascii)
        return static_cast<size_t>(values) <= m_text.size() && skip_bytes(values * property.bytes);
    for (long i = 0; i < values; ++i)
        if (!skip_word()) return false;
    return true;
}

bool PlyCursor::read(const PlyProperty& property, double& value) {
    if (m_format == PlyFormat::ascii) {
        const size_t blanks_from = m_at;
        if (!skip_word()) return false;
        const char* const word = m_text.c_str() + blanks_from;
        char* end = nullptr;
        value = std::strtod(word, &end);
        if (end == word) value = std::numeric_limits<double>::quiet_NaN();
        return true;
    }
    std::uint64_t bits = 0;
    if (!read_bits(property.bytes, bits)) return false;
    value = value_of(property.type, property.bytes, bits);
    return true;
}

bool PlyCursor::read_count(int bytes, long& count) {
    if (m_format == PlyFormat::ascii) {
        const size_t from = m_at;
        if (!skip_word()) return false;
        count = std::strtol(m_text.c_str() + from, nullptr, 10);
        return true;
    }
    std::uint64_t bits = 0;
    if (!read_bits(bytes, bits)) return false;
    count = static_cast<long>(bits);
    return true;
}

bool PlyCursor::read_bits(int bytes, std::uint64_t& bits) {
    const size_t from = m_at;
    if (!skip_bytes(bytes)) return false;
    for (int i = 0; i < bytes; ++i) {
        const int byte = m_format == PlyFormat::big_endian ? i : bytes - 1 - i;
        bits = bits << 8 | static_cast<unsigned char>(m_text[from + static_cast<size_t>(byte)]);
    }
    return true;
}

bool PlyCursor::skip_bytes(long bytes) {
    if (bytes < 0 || static_cast<size_t>(bytes) > m_text.size() - m_at) return false;
    m_at += static_cast<size_t>(bytes);
    return true;
}

bool PlyCursor::skip_word() {
    const char* const blanks = " \t\r\n";
    m_at = m_text.find_first_not_of(blanks, m_at);
    if (m_at == std::string::npos) return false;
    m_at = std::min(m_text.find_first_of(blanks, m_at), m_text.size());
    return true;
}

}  // namespace cloth
