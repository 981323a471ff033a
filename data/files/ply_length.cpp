#include "data/files/ply_length.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <vector>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

struct Property {
    int bytes = 0;        ///< of the value, or of each value of a list
    int count_bytes = 0;  ///< of the number of values of a list; 0: no list
};

struct Element {
    std::string name;
    long count = 0;
    std::vector<Property> properties;
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct Header {
    PlyFormat format = PlyFormat::ascii;
    std::vector<Element> elements;
    size_t end = 0;  ///< where the data begin
};

int bytes_of(const std::string& type) {
    if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
    if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
    if (type == "double" || type == "float64") return 8;
    return 4;
}

Header read_header(const std::string& path, const std::string& text) {
    Header header;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        std::istringstream line(text.substr(at, end - at));
        at = end + 1;
        std::string word, type, count_type;
        line >> word;
        if (word == "format") {
            line >> type;
            header.format = type == "ascii"                  ? PlyFormat::ascii
                            : type == "binary_little_endian" ? PlyFormat::little_endian
                                                             : PlyFormat::big_endian;
        } else if (word == "element") {
            header.elements.emplace_back();
            line >> header.elements.back().name >> header.elements.back().count;
        } else if (word == "property" && !header.elements.empty()) {
            line >> type;
            Property property{bytes_of(type), 0};
            if (type == "list") {
                line >> count_type >> type;
                property = {bytes_of(type), bytes_of(count_type)};
            }
            header.elements.back().properties.push_back(property);
        } else if (word == "end_header") {
            header.end = std::min(at, text.size());
            return header;
        }
    }
    throw LoadError(path, "header", "it does not end with end_header",
                    "the file is truncated: export or download it again");
}

/// Steps over the data; every step says whether the file was long enough for it.
class Walker {
 public:
    Walker(const std::string& text, const Header& header)
        : m_text(text), m_at(header.end), m_format(header.format) {}

    bool skip(const Property& property) {
        long values = 1;
        if (property.count_bytes > 0 && !read_count(property.count_bytes, values)) return false;
        if (values < 0) return false;
        if (m_format != PlyFormat::ascii)
            return static_cast<size_t>(values) <= m_text.size() &&
                   skip_bytes(values * property.bytes);
        for (long i = 0; i < values; ++i)
            if (!skip_word()) return false;
        return true;
    }

 private:
    bool read_count(int bytes, long& count) {
        if (m_format == PlyFormat::ascii) {
            const size_t from = m_at;
            if (!skip_word()) return false;
            count = std::strtol(m_text.c_str() + from, nullptr, 10);
            return true;
        }
        uint64_t value = 0;
        for (int i = 0; i < bytes; ++i) {
            const size_t byte =
                m_at + static_cast<size_t>(m_format == PlyFormat::big_endian ? i : bytes - 1 - i);
            if (byte >= m_text.size()) return false;
            value = value << 8 | static_cast<unsigned char>(m_text[byte]);
        }
        count = static_cast<long>(value);
        return skip_bytes(bytes);
    }

    bool skip_bytes(long bytes) {
        if (bytes < 0 || static_cast<size_t>(bytes) > m_text.size() - m_at) return false;
        m_at += static_cast<size_t>(bytes);
        return true;
    }

    bool skip_word() {
        const char* const blanks = " \t\r\n";
        m_at = m_text.find_first_not_of(blanks, m_at);
        if (m_at == std::string::npos) return false;
        m_at = std::min(m_text.find_first_of(blanks, m_at), m_text.size());
        return true;
    }

    const std::string& m_text;
    size_t m_at;
    PlyFormat m_format;
};

}  // namespace

void check_ply_length(const std::string& path) {
    const std::string text = read_file(path);
    const Header header = read_header(path, text);
    Walker walker(text, header);
    for (const Element& element : header.elements) {
        if (element.count < 0 || (element.count > 0 && element.properties.empty()))
            throw LoadError(path, "header, element " + printable(element.name),
                            "it has a negative number of rows, or rows without properties",
                            "export the mesh again");
        for (long row = 0; row < element.count; ++row)
            for (const Property& property : element.properties)
                if (!walker.skip(property))
                    throw LoadError(path, printable(element.name) + " " + std::to_string(row),
                                    "the file ends too early",
                                    "it is truncated: export or download it again");
    }
}

}  // namespace cloth
