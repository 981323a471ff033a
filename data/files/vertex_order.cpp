#include "data/files/vertex_order.h"

#include <assimp/fast_atof.h>
#include <unzip.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

#include "data/core/read_file.h"

namespace cloth {

std::string extension_of(const std::string& path) {
    std::string extension = path.substr(std::min(path.size(), path.rfind('.') + 1));
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

std::string read_zipped_dae(const std::string& path) {
    const std::unique_ptr<void, int (*)(void*)> archive(unzOpen(path.c_str()), unzClose);
    if (!archive) return "";
    for (int found = unzGoToFirstFile(archive.get()); found == UNZ_OK;
         found = unzGoToNextFile(archive.get())) {
        char name[512];
        unz_file_info info;
        unzGetCurrentFileInfo(archive.get(), &info, name, sizeof(name), nullptr, 0, nullptr, 0);
        if (extension_of(name) != "dae" || unzOpenCurrentFile(archive.get()) != UNZ_OK) continue;
        std::string text;
        char buffer[65536];
        for (int n; (n = unzReadCurrentFile(archive.get(), buffer, sizeof(buffer))) > 0;)
            text.append(buffer, static_cast<size_t>(n));
        unzCloseCurrentFile(archive.get());
        return text;
    }
    return "";
}

namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// fast_atof.h wants an exception that may be built from anything; assimp's own is not exported. It
/// is thrown for what strtod() takes for a number and assimp does not.
struct NotANumber : std::runtime_error {
    template <typename... Parts>
    explicit NotANumber(Parts&&...) : std::runtime_error("not a number") {}
};

/// Reads one number twice: as assimp does, to find it again, and at full precision.
bool read_number(const char*& cursor, float& as_assimp, double& value) {
    while (is_blank(*cursor)) ++cursor;
    char* end = nullptr;
    value = std::strtod(cursor, &end);
    if (end == cursor || !std::isfinite(value)) return false;
    try {
        Assimp::fast_atoreal_move<float, NotANumber>(cursor, as_assimp);
    } catch (const NotANumber&) {
        return false;
    }
    cursor = end;
    return true;
}

bool read_position(const char*& cursor, FilePositions& positions, int index) {
    std::array<float, 3> key{};
    FilePosition position;
    position.index = index;
    for (int axis = 0; axis < 3; ++axis)
        if (!read_number(cursor, key[static_cast<size_t>(axis)], position.value[axis]))
            return false;
    positions.try_emplace(key, position);
    return true;
}

/// Where the numbers of each position of an OBJ file begin.
std::vector<size_t> obj_numbers(const std::string& text) {
    std::vector<size_t> begins;
    for (size_t line = 0; line < text.size(); line = text.find('\n', line)) {
        while (line < text.size() && is_blank(text[line])) ++line;
        if (line + 1 >= text.size()) break;
        if (text[line] == 'v' && is_blank(text[line + 1])) begins.push_back(line + 1);
    }
    return begins;
}

FilePositions obj_positions(const std::string& text) {
    FilePositions positions;
    int index = 0;
    for (const size_t begin : obj_numbers(text)) {
        const char* cursor = text.c_str() + begin;
        read_position(cursor, positions, index++);
    }
    return positions;
}

/// The value of an attribute of the tag that starts at `tag`, "" if it has none.
std::string attribute(const std::string& text, size_t tag, const std::string& name) {
    const size_t end = text.find('>', tag);
    const size_t key = text.find(' ' + name + "=", tag);
    if (key == std::string::npos || key > end) return "";
    const size_t quote = key + name.size() + 2;
    const size_t closing = text.find(text[quote], quote + 1);
    if (closing == std::string::npos || closing > end) return "";
    return text.substr(quote + 1, closing - quote - 1);
}

/// Where the position list of one <geometry> begins: <vertices> names the <source> that holds the
/// numbers. npos: it has none.
size_t geometry_numbers(const std::string& geometry) {
    constexpr size_t none = std::string::npos;
    const size_t vertices = geometry.find("<vertices");
    if (vertices == none) return none;
    size_t input = geometry.find("<input", vertices);
    while (input != none && attribute(geometry, input, "semantic") != "POSITION")
        input = geometry.find("<input", input + 1);
    if (input == none) return none;
    const std::string id = attribute(geometry, input, "source");
    size_t source = geometry.find("<source");
    while (source != none && '#' + attribute(geometry, source, "id") != id)
        source = geometry.find("<source", source + 1);
    const size_t numbers = geometry.find("<float_array", source);
    if (source == none || numbers == none) return none;
    return geometry.find('>', numbers) + 1;
}

/// The position list of one <geometry>.
struct ColladaList {
    std::string name;                    ///< the geometry's id
    std::string text;                    ///< of the geometry
    size_t offset = 0;                   ///< of `text` in the file
    size_t numbers = std::string::npos;  ///< where they begin in `text`, npos: there are none
};

std::vector<ColladaList> collada_lists(const std::string& text) {
    std::vector<ColladaList> lists;
    for (size_t tag = text.find("<geometry "); tag != std::string::npos;
         tag = text.find("<geometry ", tag + 1)) {
        const size_t end = text.find("</geometry>", tag);
        const std::string geometry = text.substr(tag, end - tag);
        lists.push_back({attribute(text, tag, "id"), geometry, tag, geometry_numbers(geometry)});
    }
    return lists;
}

std::map<std::string, FilePositions> collada_positions(const std::string& text) {
    std::map<std::string, FilePositions> positions;
    for (const ColladaList& list : collada_lists(text)) {
        FilePositions& found = positions[list.name] = {};
        if (list.numbers == std::string::npos) continue;
        const char* cursor = list.text.c_str() + list.numbers;
        for (int index = 0; read_position(cursor, found, index); ++index) {
        }
    }
    return positions;
}

using Key = std::array<float, 3>;

/// Reads a position as assimp does, finite or not.
bool read_as_assimp(const char*& cursor, Key& key) {
    for (float& number : key) {
        while (is_blank(*cursor)) ++cursor;
        if (*cursor == '\0' || *cursor == '<') return false;
        try {
            cursor = Assimp::fast_atoreal_move<float, NotANumber>(cursor, number);
        } catch (const NotANumber&) {
            return false;
        }
    }
    return true;
}

bool is_finite(const Key& key) {
    return std::all_of(key.begin(), key.end(), [](float number) { return std::isfinite(number); });
}

bool is_same(const Key& a, const Key& b) {
    return std::equal(a.begin(), a.end(), b.begin(),
                      [](float p, float q) { return p == q || (std::isnan(p) && std::isnan(q)); });
}

/// Keeps the place of the wanted position, or else of the first that is not finite.
class BadPositionSearch {
 public:
    explicit BadPositionSearch(const Key& wanted) : m_wanted(wanted) {}

    void see(const Key& key, size_t offset, const std::string& detail) {
        if (m_exact || is_finite(key)) return;
        m_exact = is_same(key, m_wanted);
        if (m_found && !m_exact) return;
        m_found = true;
        m_offset = offset;
        m_detail = detail;
    }

    std::string place(const std::string& text) const {
        if (!m_found) return "";
        const auto end = text.begin() + static_cast<std::ptrdiff_t>(m_offset);
        return "line " + std::to_string(1 + std::count(text.begin(), end, '\n')) + m_detail;
    }

 private:
    Key m_wanted;
    bool m_found = false, m_exact = false;
    size_t m_offset = 0;
    std::string m_detail;
};

std::string place_in_obj(const std::string& text, const Key& wanted) {
    BadPositionSearch search(wanted);
    for (const size_t begin : obj_numbers(text)) {
        const char* cursor = text.c_str() + begin;
        Key key{};
        if (read_as_assimp(cursor, key)) search.see(key, begin, "");
    }
    return search.place(text);
}

std::string place_in_collada(const std::string& text, const std::string& geometry,
                             const Key& wanted) {
    BadPositionSearch search(wanted);
    for (const ColladaList& list : collada_lists(text)) {
        if (list.name != geometry || list.numbers == std::string::npos) continue;
        const char* cursor = list.text.c_str() + list.numbers;
        Key key{};
        for (int index = 0; read_as_assimp(cursor, key); ++index)
            search.see(key, list.offset + static_cast<size_t>(cursor - list.text.c_str()),
                       ", position " + std::to_string(index) + " of geometry " + geometry);
    }
    return search.place(text);
}

}  // namespace

std::map<std::string, FilePositions> read_file_positions(const std::string& path) {
    const std::string extension = extension_of(path);
    if (extension == "obj") return {{"", obj_positions(read_text_file(path))}};
    if (extension == "dae") return collada_positions(read_file(path));
    if (extension == "zae") return collada_positions(read_zipped_dae(path));
    return {};
}

std::string place_of_bad_position(const std::string& path, const std::string& mesh,
                                  const std::array<float, 3>& position) {
    const std::string extension = extension_of(path);
    if (extension == "obj") return place_in_obj(read_text_file(path), position);
    if (extension == "dae") return place_in_collada(read_file(path), mesh, position);
    if (extension == "zae") return place_in_collada(read_zipped_dae(path), mesh, position);
    return "";
}

}  // namespace cloth
