#include "data/files/mesh_file_check.h"

#include <unzip.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "data/files/gltf_check.h"
#include "data/files/ply_length.h"
#include "data/files/vertex_order.h"

namespace cloth {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int deepest = 500;  // brackets or tags; files of real scenes have a few dozen
const char* const export_again = "export or download it again";

[[noreturn]] void fail(const std::string& path, const std::string& place,
                       const std::string& problem) {
    throw LoadError(path, place, "cannot be read: " + problem, export_again);
}

void check_json_depth(const std::string& path, const std::string& text) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\') ++i;
        if (c == '"') quoted = !quoted;
        if (quoted) continue;
        depth += (c == '[' || c == '{') - (c == ']' || c == '}');
        if (depth > deepest) fail(path, "", "its values are nested too deeply");
    }
}

void check_xml_depth(const std::string& path, const std::string& text) {
    int depth = 0;
    for (size_t i = 0; i + 1 < text.size(); ++i) {
        if (text[i] == '<' && text[i + 1] == '/')
            --depth;
        else if (text[i] == '<' && text[i + 1] != '!' && text[i + 1] != '?')
            ++depth;
        else if (text[i] == '/' && text[i + 1] == '>')
            --depth;
        if (depth > deepest) fail(path, "", "its tags are nested too deeply");
    }
}

/// Every attribute of this name is a number that the file is long enough for.
void check_numbers(const std::string& path, const std::string& text, const std::string& name) {
    const std::string key = " " + name + "=\"";
    for (size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
        const size_t begin = at + key.size();
        const size_t end = text.find_first_not_of("0123456789", begin);
        const bool whole = end != std::string::npos && end > begin && text[end] == '"';
        if (!whole || end - begin > 9 || std::stoul(text.substr(begin, 9)) > text.size())
            fail(path, "byte " + std::to_string(at), "the " + name + " does not fit the file");
    }
}

/// Polygons have no more corners in all than the file has room for.
void check_polygons(const std::string& path, const std::string& text) {
    const std::string key = "<vcount>";
    for (size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
        const size_t end = text.find('<', at + key.size());
        std::istringstream numbers(text.substr(at + key.size(), end - at - key.size()));
        size_t corners = 0;
        for (size_t n; corners <= text.size() && numbers >> n;) corners += std::min(n, text.size());
        if (corners >= text.size())
            fail(path, "byte " + std::to_string(at),
                 "polygons have more corners than fit the file");
    }
}

void check_collada(const std::string& path, const std::string& text) {
    check_xml_depth(path, text);
    for (const char* name : {"count", "offset", "stride"}) check_numbers(path, text, name);
    check_polygons(path, text);
}

/// The JSON of a .gltf file, or the first chunk of a .glb file.
std::string gltf_json(const std::string& path, const std::string& bytes) {
    if (bytes.compare(0, 4, "glTF") != 0) return bytes;
    std::uint32_t length = 0;
    constexpr size_t begin = 20;  // header and the chunk's length and type
    if (bytes.size() >= begin) std::memcpy(&length, &bytes[12], sizeof length);
    if (bytes.size() < begin || length > bytes.size() - begin) fail(path, "", "it is truncated");
    return bytes.substr(begin, length);
}

/// Bytes of the file and of those it refers to: nothing in it can be larger.
std::uintmax_t bytes_at_hand(const std::string& path, const json& root) {
    std::uintmax_t sum = fs::file_size(path);
    for (const json& buffer : root.value("buffers", json::array())) {
        const std::string uri = buffer.value("uri", "");
        if (uri.empty() || uri.compare(0, 5, "data:") == 0) continue;
        std::error_code error;
        const std::uintmax_t size = fs::file_size(fs::path(path).parent_path() / uri, error);
        if (!error) sum += size;
    }
    return sum;
}

void check_gltf_values(const std::string& path, const json& root) {
    const std::uintmax_t most = bytes_at_hand(path, root);
    for (const auto& [list, field] :
         {std::pair("accessors", "count"), std::pair("bufferViews", "byteLength"),
          std::pair("buffers", "byteLength")})
        for (const json& entry : root.value(list, json::array()))
            if (entry.value(field, json(0)).get<double>() > static_cast<double>(most))
                fail(path, list, std::string("a ") + field + " is larger than the file");
    for (const json& skin : root.value("skins", json::array()))
        if (!skin.contains("inverseBindMatrices"))
            fail(path, "skins", "one has no inverseBindMatrices");
}

void check_gltf(const std::string& path, const std::string& bytes) {
    const std::string text = gltf_json(path, bytes);
    check_json_depth(path, text);
    try {
        const json root = json::parse(text);
        check_gltf_values(path, root);
        // Lists of glTF 1.0 are objects.
        if (root.contains("accessors") && root["accessors"].is_array()) check_gltf_parts(path);
    } catch (const json::exception& error) {
        fail(path, "", error.what());
    }
}

/// Unpacks the archive, as assimp will, which takes its parts for whole.
void check_archive(const std::string& path) {
    constexpr uLong deflates_at_most = 1100;  // bytes out of one
    const std::uintmax_t file_size = fs::file_size(path);
    const std::unique_ptr<void, int (*)(void*)> archive(unzOpen(path.c_str()), unzClose);
    if (!archive) fail(path, "", "it is no zip archive, or truncated");
    int found = unzGoToFirstFile(archive.get());
    for (; found == UNZ_OK; found = unzGoToNextFile(archive.get())) {
        unz_file_info info;
        char buffer[65536];
        if (unzGetCurrentFileInfo(archive.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0) ||
            info.uncompressed_size > deflates_at_most * file_size ||
            unzOpenCurrentFile(archive.get()) != UNZ_OK)
            fail(path, "", "a part of the archive is damaged");
        uLong size = 0;
        for (int n; (n = unzReadCurrentFile(archive.get(), buffer, sizeof buffer)) > 0;)
            size += static_cast<uLong>(n);
        if (unzCloseCurrentFile(archive.get()) != UNZ_OK || size != info.uncompressed_size)
            fail(path, "", "a part of the archive is damaged");
    }
    if (found != UNZ_END_OF_LIST_OF_FILE) fail(path, "", "the archive's list is damaged");
}

}  // namespace

void check_mesh_file(const std::string& path) {
    std::error_code error;
    if (fs::is_directory(path, error))
        throw LoadError(path, "", "is a folder", "give the path of a file");
    if (!fs::is_regular_file(path, error))
        throw LoadError(path, "", "there is no such file", "check the path");
    if (fs::file_size(path, error) == 0)
        throw LoadError(path, "", "cannot be read: the file is empty", export_again);
    const std::string extension = extension_of(path);
    if (extension == "ply") check_ply_length(path);
    if (extension == "gltf" || extension == "glb") check_gltf(path, read_file(path));
    if (extension == "dae") check_collada(path, read_file(path));
    if (extension == "zae") {
        check_archive(path);
        check_collada(path, read_zipped_dae(path));
    }
}

}  // namespace cloth
