#include "data/files/gltf_numbers.h"

#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "data/core/errors.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

using nlohmann::json;

constexpr int type_float = 5126, bytes8 = 5121, bytes16 = 5123, bytes32 = 5125;  // of glTF

std::uint32_t word_at(const std::string& bytes, size_t at) {
    std::uint32_t word = 0;
    if (at <= bytes.size() && bytes.size() - at >= sizeof word)
        std::memcpy(&word, &bytes[at], sizeof word);
    return word;
}

/// The JSON, and the bytes of the first buffer if they are in the file.
std::pair<std::string, std::string> chunks_of(const std::string& file) {
    if (file.compare(0, 4, "glTF") != 0) return {file, ""};
    constexpr size_t header = 12, head = 8;  // of the file, and of a chunk
    const size_t length = word_at(file, header), text = header + head;
    if (file.size() < text || length > file.size() - text) return {"", ""};
    const size_t next = text + length;
    std::string binary;
    if (next <= file.size() && file.size() - next >= head)
        binary = file.substr(next + head, word_at(file, next));
    return {file.substr(text, length), binary};
}

std::string without_percents(const std::string& uri) {
    std::string name;
    for (size_t i = 0; i < uri.size(); ++i) {
        const auto is_hex = [&](size_t k) {
            return k < uri.size() && std::isxdigit(uri[k] & 0x7f);
        };
        if (uri[i] == '%' && is_hex(i + 1) && is_hex(i + 2)) {
            name += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            name += uri[i];
        }
    }
    return name;
}

}  // namespace

std::string from_base64(const std::string& text) {
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        int digit = 0;
        if (c >= 'A' && c <= 'Z')
            digit = c - 'A';
        else if (c >= 'a' && c <= 'z')
            digit = c - 'a' + 26;
        else if (c >= '0' && c <= '9')
            digit = c - '0' + 52;
        else if (c == '+' || c == '/')
            digit = c == '+' ? 62 : 63;
        else
            break;
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        if (++count % 4 == 0) {
            for (int shift = 16; shift >= 0; shift -= 8)
                bytes += static_cast<char>(bits >> shift & 0xff);
            bits = 0;
        }
    }
    if (count % 4 == 2) bytes += static_cast<char>(bits >> 4 & 0xff);
    if (count % 4 == 3)
        for (int shift = 10; shift >= 2; shift -= 8)
            bytes += static_cast<char>(bits >> shift & 0xff);
    return bytes;
}

GltfNumbers::GltfNumbers(std::string path) : m_path(std::move(path)) {
    std::string text;
    std::tie(text, m_binary) = chunks_of(read_file(m_path));
    m_root = std::make_unique<json>(json::parse(text, nullptr, /*allow_exceptions=*/false));
    if (!m_root->is_object()) fail("", "it is no glTF file", "export it again");
}

GltfNumbers::~GltfNumbers() = default;

void GltfNumbers::fail(const std::string& place, const std::string& problem,
                       const std::string& remedy) const {
    throw LoadError(m_path, place, problem, remedy);
}

size_t GltfNumbers::index(const json& object, const char* key, const std::string& place) const {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (!object.is_object() || found == object.end() || !found->is_number_integer() ||
        found->get<double>() < 0.0)
        fail(place, std::string("its ") + key + " is missing or no whole number",
             "export the file again");
    return found->get<size_t>();
}

const json& GltfNumbers::entry(const char* list, size_t number, const std::string& place) const {
    const auto found = m_root->find(list);
    if (found == m_root->end() || !found->is_array() || number >= found->size())
        fail(place, "it refers to " + std::string(list) + " that are not there",
             "export the file again");
    return (*found)[number];
}

const std::string& GltfNumbers::buffer(size_t number, const std::string& place) {
    const auto known = m_buffers.find(number);
    if (known != m_buffers.end()) return known->second;
    const json& entry = this->entry("buffers", number, place);
    const auto found = entry.is_object() ? entry.find("uri") : entry.end();
    const bool is_named = entry.is_object() && found != entry.end() && found->is_string();
    if (!is_named) return m_buffers[number] = number == 0 ? m_binary : "";
    const auto uri = found->get<std::string>();
    if (uri.compare(0, 5, "data:") == 0) {
        const size_t comma = uri.find(',');
        return m_buffers[number] =
                   comma == std::string::npos ? "" : from_base64(uri.substr(comma + 1));
    }
    const std::filesystem::path folder = std::filesystem::path(m_path).parent_path();
    return m_buffers[number] = read_file((folder / without_percents(uri)).string());
}

size_t GltfNumbers::count(size_t accessor, const std::string& place) const {
    return index(entry("accessors", accessor, place), "count", place);
}

bool GltfNumbers::is_plain(size_t accessor, const std::string& place) const {
    const json& entry = this->entry("accessors", accessor, place);
    if (!entry.is_object() || entry.contains("sparse") || !entry.contains("bufferView"))
        return false;
    const json& view = this->entry("bufferViews", index(entry, "bufferView", place), place);
    return view.is_object() && !view.contains("extensions");
}

const json& GltfNumbers::typed_entry(size_t accessor, int components,
                                     const std::string& place) const {
    const json& entry = this->entry("accessors", accessor, place);
    const std::string type = components == 1 ? "SCALAR" : "VEC" + std::to_string(components);
    const auto found = entry.is_object() ? entry.find("type") : entry.end();
    if (!entry.is_object() || found == entry.end() || *found != type)
        fail(place, "it is not of the type " + type, "store one " + type + " per vertex");
    if (entry.contains("sparse") || !entry.contains("bufferView"))
        fail(place, "it is stored sparsely, or not at all", "store one number per vertex");
    return entry;
}

GltfNumbers::Elements GltfNumbers::elements(const json& accessor, size_t size, int components,
                                            const std::string& place) {
    const size_t count = index(accessor, "count", place);
    const json& view = this->entry("bufferViews", index(accessor, "bufferView", place), place);
    const std::string& bytes = buffer(index(view, "buffer", place), place);
    const size_t packed = size * static_cast<size_t>(components);
    const size_t stride = view.contains("byteStride") ? index(view, "byteStride", place) : packed;
    const size_t view_begin = view.contains("byteOffset") ? index(view, "byteOffset", place) : 0;
    const size_t offset =
        accessor.contains("byteOffset") ? index(accessor, "byteOffset", place) : 0;
    const size_t all = bytes.size();
    const bool fits =
        view_begin <= all && offset <= all - view_begin && count <= all && stride <= all &&
        stride >= packed &&
        (count == 0 || (all - view_begin - offset >= packed &&
                        (count - 1) <= (all - view_begin - offset - packed) / stride));
    if (!fits)
        fail(place, "its numbers are beyond the end of the file",
             "the file is truncated or damaged: export it again");
    return {bytes.data() + view_begin + offset, count, stride};
}

std::vector<float> GltfNumbers::read(size_t accessor, int components, const std::string& place) {
    const json& entry = typed_entry(accessor, components, place);
    const size_t component = index(entry, "componentType", place);
    const bool is_normalised =
        entry.contains("normalized") && entry["normalized"].is_boolean() && entry["normalized"];
    if (component != type_float &&
        !(is_normalised && (component == bytes8 || component == bytes16)))
        fail(place, "its numbers are neither floats nor normalised bytes or 16-bit numbers",
             "store it as 32-bit floats");
    const size_t size = component == type_float ? 4 : component == bytes16 ? 2 : 1;
    const Elements stored = elements(entry, size, components, place);
    std::vector<float> numbers;
    numbers.reserve(stored.count * static_cast<size_t>(components));
    for (size_t i = 0; i < stored.count; ++i)
        for (size_t c = 0; c < static_cast<size_t>(components); ++c) {
            const char* const at = stored.first + i * stored.stride + c * size;
            std::uint8_t byte = 0;
            std::uint16_t word = 0;
            float number = 0.0f;
            if (component == type_float)
                std::memcpy(&number, at, sizeof number);
            else if (component == bytes16)
                std::memcpy(&word, at, sizeof word), number = static_cast<float>(word) / 65535.0f;
            else
                std::memcpy(&byte, at, sizeof byte), number = static_cast<float>(byte) / 255.0f;
            numbers.push_back(number);
        }
    return numbers;
}

std::vector<std::uint32_t> GltfNumbers::read_whole(size_t accessor, int components,
                                                   const std::string& place) {
    const json& entry = typed_entry(accessor, components, place);
    const size_t component = index(entry, "componentType", place);
    if (component != bytes8 && component != bytes16 && component != bytes32)
        fail(place, "its numbers are no whole numbers without a sign", "export the file again");
    const size_t size = component == bytes32 ? 4 : component == bytes16 ? 2 : 1;
    const Elements stored = elements(entry, size, components, place);
    std::vector<std::uint32_t> numbers;
    numbers.reserve(stored.count * static_cast<size_t>(components));
    for (size_t i = 0; i < stored.count; ++i)
        for (size_t c = 0; c < static_cast<size_t>(components); ++c) {
            std::uint32_t number = 0;  // glTF is little-endian, as is this machine
            std::memcpy(&number, stored.first + i * stored.stride + c * size, size);
            numbers.push_back(number);
        }
    return numbers;
}

}  // namespace cloth
