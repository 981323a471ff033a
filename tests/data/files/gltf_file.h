#pragma once

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "data/core/paths.h"
#include "data/core/read_file.h"
#include "data/files/gltf_numbers.h"

namespace cloth::test {

/// Khronos' SimpleSkin, a strip of 10 vertices with two joints, to be broken: its JSON, and one
/// buffer with the numbers of the four it has.
struct GltfFile {
    nlohmann::json json;
    std::string bytes;

    GltfFile()
        : json(nlohmann::json::parse(read_file(model_path("glTF2/simple_skin/simple_skin.gltf")))) {
        std::vector<size_t> begins;
        for (const auto& buffer : json["buffers"]) {
            const std::string uri = buffer["uri"];
            begins.push_back(bytes.size());
            bytes += from_base64(uri.substr(uri.find(',') + 1));
        }
        for (auto& view : json["bufferViews"]) {
            view["byteOffset"] =
                begins[view["buffer"].get<size_t>()] + view["byteOffset"].get<size_t>();
            view["buffer"] = 0;
        }
    }

    /// Overwrites a number of an accessor, counted from the accessor's first byte.
    template <typename Number>
    void set(size_t accessor, size_t index, Number number) {
        const auto& entry = json["accessors"][accessor];
        const auto& view = json["bufferViews"][entry["bufferView"].get<size_t>()];
        const size_t begin = view["byteOffset"].get<size_t>() + entry["byteOffset"].get<size_t>();
        std::memcpy(&bytes[begin + index * sizeof number], &number, sizeof number);
    }

    /// Writes NAME and, beside it, NAME.bin.
    void save(const std::string& path) {
        const std::string name = path.substr(path.rfind('/') + 1);
        json["buffers"] = {{{"uri", name + ".bin"}, {"byteLength", bytes.size()}}};
        std::ofstream(path) << json.dump();
        std::ofstream(path + ".bin", std::ios::binary) << bytes;
    }
};

}  // namespace cloth::test
