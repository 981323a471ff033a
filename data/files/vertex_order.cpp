#include "data/files/vertex_order.h"

#include <assimp/fast_atof.h>
#include <unzip.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>

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

FilePositions obj_positions(const std::string& text) {
    FilePositions positions;
    int index = 0;
    for (size_t line = 0; line < text.size(); line = text.find('\n', line)) {
        while (line < text.size() && is_blank(text[line])) ++line;
        if (line + 1 >= text.size()) break;
        if (text[line] != 'v' || !is_blank(text[line + 1])) continue;
        const char* cursor = text.c_str() + line + 1;
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

/// The position list of one <geometry>: <vertices> names the <source> that holds the numbers.
FilePositions geometry_positions(const std::string& geometry) {
    FilePositions positions;
    const size_t vertices = geometry.find("<vertices");
    if (vertices == std::string::npos) return positions;
    size_t input = geometry.find("<input", vertices);
    while (input != std::string::npos && attribute(geometry, input, "semantic") != "POSITION")
        input = geometry.find("<input", input + 1);
    if (input == std::string::npos) return positions;
    const std::string id = attribute(geometry, input, "source");
    size_t source = geometry.find("<source");
    while (source != std::string::npos && '#' + attribute(geometry, source, "id") != id)
        source = geometry.find("<source", source + 1);
    const size_t numbers = geometry.find("<float_array", source);
    if (source == std::string::npos || numbers == std::string::npos) return positions;
    const char* cursor = geometry.c_str() + geometry.find('>', numbers) + 1;
    for (int index = 0; read_position(cursor, positions, index); ++index) {
    }
    return positions;
}

std::map<std::string, FilePositions> collada_positions(const std::string& text) {
    std::map<std::string, FilePositions> lists;
    for (size_t tag = text.find("<geometry "); tag != std::string::npos;
         tag = text.find("<geometry ", tag + 1)) {
        const size_t end = text.find("</geometry>", tag);
        lists[attribute(text, tag, "id")] = geometry_positions(text.substr(tag, end - tag));
    }
    return lists;
}

}  // namespace

std::map<std::string, FilePositions> read_file_positions(const std::string& path) {
    const std::string extension = extension_of(path);
    if (extension == "obj") return {{"", obj_positions(read_file(path))}};
    if (extension == "dae") return collada_positions(read_file(path));
    if (extension == "zae") return collada_positions(read_zipped_dae(path));
    return {};
}

}  // namespace cloth
