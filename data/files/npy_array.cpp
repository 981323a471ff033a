#include "data/files/npy_array.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

const char* const save_again = "save it again with numpy.save or numpy.savez, allow_pickle=False";

/// What the header of a .npy says.
struct NpyHeader {
    char kind = 0;     ///< b, i, u, f, U or S
    size_t width = 0;  ///< bytes of an element
    bool big_endian = false, fortran = false;
    std::vector<std::int64_t> shape;
    size_t count = 1;
};

/// Reads the dictionary of a header, as NumPy writes it.
class HeaderParser {
 public:
    HeaderParser(const std::string& text, const std::string& file, const std::string& place)
        : m_text(text), m_file(file), m_place(place) {}

    NpyHeader parse() const {
        NpyHeader header;
        parse_type(value_of("'descr'"), header);
        const std::string order = value_of("'fortran_order'");
        header.fortran = order.rfind("True", 0) == 0;
        if (!header.fortran && order.rfind("False", 0) != 0)
            fail("its fortran_order is no boolean");
        parse_shape(value_of("'shape'"), header);
        return header;
    }

    [[noreturn]] void fail(const std::string& problem) const {
        throw LoadError(m_file, m_place, problem, save_again);
    }

 private:
    std::string value_of(const std::string& key) const {
        const size_t at = m_text.find(key);
        if (at == std::string::npos) fail("its header has no " + key);
        const size_t begin = m_text.find_first_not_of(" :", at + key.size());
        return begin == std::string::npos ? "" : m_text.substr(begin);
    }

    void parse_type(const std::string& value, NpyHeader& header) const {
        const size_t end = value.find('\'', 1);
        if (value.empty() || value[0] != '\'' || end == std::string::npos)
            fail("its elements have several fields, or no type");
        const std::string type = value.substr(1, end - 1);
        if (type == "|O") fail("it holds Python objects");
        if (type.size() < 3 || type.size() > 8 || !std::strchr("<>|=", type[0]) ||
            !std::all_of(type.begin() + 2, type.end(),
                         [](unsigned char c) { return std::isdigit(c); }))
            fail("its type '" + printable(type) + "' is not known");
        header.kind = type[1];
        header.big_endian = type[0] == '>';
        header.width = static_cast<size_t>(std::stoi(type.substr(2)));
        const size_t w = header.width;
        const bool integer = w == 1 || w == 2 || w == 4 || w == 8;
        bool known = false;
        switch (header.kind) {
            case 'b':
                known = w == 1;
                break;
            case 'i':
            case 'u':
                known = integer;
                break;
            case 'f':
                known = w == 4 || w == 8;
                break;
            case 'U':
                known = w < 100000;
                header.width *= 4;
                break;
            case 'S':
                known = true;
                break;
            default:
                break;
        }
        if (!known) fail("numbers of type '" + printable(type) + "' cannot be read");
    }

    void parse_shape(const std::string& value, NpyHeader& header) const {
        if (value.empty() || value[0] != '(' || value.find(')') == std::string::npos)
            fail("it has no shape");
        std::string digits;
        for (const char c : value.substr(1, value.find(')'))) {
            if (std::isdigit(static_cast<unsigned char>(c))) {
                digits += c;
                continue;
            }
            if (!std::strchr(" ,)L", c)) fail("its shape is not of numbers");
            if (digits.empty()) continue;
            if (digits.size() > 12) fail("its shape is too large");
            header.shape.push_back(std::stoll(digits));
            const auto extent = static_cast<size_t>(header.shape.back());
            if (extent > 0 && header.count > std::numeric_limits<size_t>::max() / 64 / extent)
                fail("its shape is too large");
            header.count *= extent;
            digits.clear();
        }
        if (header.shape.size() > 32) fail("it has too many axes");
    }

    const std::string &m_text, &m_file, &m_place;
};

template <class Number>
double number_at(const char* bytes, bool big_endian) {
    char raw[sizeof(Number)];
    std::memcpy(raw, bytes, sizeof raw);
    if (big_endian) std::reverse(std::begin(raw), std::end(raw));
    Number number;
    std::memcpy(&number, raw, sizeof number);
    return static_cast<double>(number);
}

using NumberReader = double (*)(const char*, bool);

NumberReader reader_of(const NpyHeader& header) {
    if (header.kind == 'f') return header.width == 4 ? number_at<float> : number_at<double>;
    const bool has_sign = header.kind == 'i';
    switch (header.width) {
        case 1:
            return has_sign ? number_at<std::int8_t> : number_at<std::uint8_t>;
        case 2:
            return has_sign ? number_at<std::int16_t> : number_at<std::uint16_t>;
        case 4:
            return has_sign ? number_at<std::int32_t> : number_at<std::uint32_t>;
        default:
            return has_sign ? number_at<std::int64_t> : number_at<std::uint64_t>;
    }
}

std::string read_text(const char* data, const NpyHeader& header) {
    std::string text;
    const size_t step = header.kind == 'U' ? 4 : 1;
    for (size_t at = 0; at < header.width; at += step) {
        const char c = data[header.big_endian ? at + step - 1 : at];
        if (c == 0) break;
        text += c;
    }
    return text;
}

/// Elements in the order of the last index first, from those with the first index first.
std::vector<double> to_c_order(const std::vector<double>& numbers,
                               const std::vector<std::int64_t>& shape) {
    std::vector<double> sorted(numbers.size());
    std::vector<std::int64_t> index(shape.size(), 0);
    for (const double number : numbers) {
        std::int64_t place = 0;
        for (size_t axis = 0; axis < shape.size(); ++axis)
            place = place * shape[axis] + index[axis];
        sorted[static_cast<size_t>(place)] = number;
        for (size_t axis = 0; axis < shape.size() && ++index[axis] == shape[axis]; ++axis)
            index[axis] = 0;
    }
    return sorted;
}

}  // namespace

std::int64_t NpyArray::size() const {
    std::int64_t count = 1;
    for (const std::int64_t extent : shape) count *= extent;
    return count;
}

NpyArray parse_npy(const std::string& bytes, const std::string& file, const std::string& place) {
    const auto fail = [&](const std::string& problem) {
        throw LoadError(file, place, problem, save_again);
    };
    if (bytes.size() < 12 || bytes.compare(0, 6, "\x93NUMPY") != 0) fail("is not in .npy format");
    const size_t field = bytes[6] == 1 ? 2 : 4;
    size_t length = 0;
    for (size_t k = 0; k < field; ++k)
        length |= static_cast<size_t>(static_cast<unsigned char>(bytes[8 + k])) << (8 * k);
    const size_t begin = 8 + field;
    if (length > bytes.size() - begin) fail("is cut off in its header");
    const std::string text = bytes.substr(begin, length);
    const NpyHeader header = HeaderParser(text, file, place).parse();
    const size_t held = bytes.size() - begin - length;
    if (header.width > 0 && header.count > held / header.width)
        fail("is cut off: it holds fewer numbers than it says");
    NpyArray array;
    array.shape = header.shape;
    const char* data = bytes.data() + begin + length;
    if (header.kind == 'U' || header.kind == 'S') {
        if (header.count != 1) fail("holds several texts, where one is expected");
        array.is_text = true;
        array.text = read_text(data, header);
        return array;
    }
    const NumberReader read = reader_of(header);
    array.numbers.resize(header.count);
    for (size_t k = 0; k < header.count; ++k)
        array.numbers[k] = read(data + k * header.width, header.big_endian);
    if (header.fortran && header.shape.size() > 1)
        array.numbers = to_c_order(array.numbers, header.shape);
    return array;
}

NpyArray load_npy(const std::string& path) {
    return parse_npy(read_file(path), path, "");
}

}  // namespace cloth
