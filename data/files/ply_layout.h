#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cloth {

struct PlyProperty {
    std::string name;
    std::string type;     ///< of the value, or of each value of a list, as the header writes it
    int bytes = 0;        ///< of that
    int count_bytes = 0;  ///< of the number of values of a list; 0: no list
};

struct PlyElement {
    std::string name;
    long count = 0;
    std::vector<PlyProperty> properties;
};

enum class PlyFormat { ascii, little_endian, big_endian };

/// What the header of a PLY file says of the rest.
struct PlyLayout {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    size_t data = 0;  ///< where they begin (bytes)
};

/// @param text  the bytes of the whole file
/// @throws LoadError if the header does not end, an element has a negative number of rows, or rows
///         without properties
PlyLayout read_ply_layout(const std::string& path, const std::string& text);

/// Goes through the data of a PLY file, value by value, in the order of the layout. Each call says
/// whether the file was long enough for it.
class PlyCursor {
 public:
    PlyCursor(const std::string& text, const PlyLayout& layout)
        : m_text(text), m_at(layout.data), m_format(layout.format) {}

    bool skip(const PlyProperty& property);
    /// The value of a property that is no list; NaN for a word that is no number.
    bool read(const PlyProperty& property, double& value);

 private:
    bool read_count(int bytes, long& count);
    bool read_bits(int bytes, std::uint64_t& bits);
    bool skip_bytes(long bytes);
    bool skip_word();

    const std::string& m_text;
    size_t m_at;
    PlyFormat m_format;
};

}  // namespace cloth
