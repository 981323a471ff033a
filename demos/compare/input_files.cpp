#include "demos/compare/input_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "data/body/outfit.h"
#include "data/core/paths.h"
#include "data/core/read_file.h"

namespace cloth {
namespace {

namespace fs = std::filesystem;

std::string hash_of(const std::string& bytes) {
    std::uint64_t hash = 14695981039346656037ULL;
    for (const char byte : bytes) {
        hash ^= static_cast<unsigned char>(byte);
        hash *= 1099511628211ULL;
    }
    std::array<char, 17> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash));
    return digits.data();
}

/// The files beside a .gltf that have its positions. What is no glTF is refused where it is loaded.
void add_buffers(const std::string& gltf, std::vector<std::string>& files) {
    const auto document = nlohmann::json::parse(read_file(gltf), nullptr, false);
    if (!document.is_object() || !document.contains("buffers")) return;
    for (const auto& buffer : document.at("buffers")) {
        if (!buffer.is_object() || !buffer.contains("uri") || !buffer.at("uri").is_string())
            continue;
        const fs::path path = fs::path(gltf).parent_path() / buffer.at("uri").get<std::string>();
        if (fs::is_regular_file(path)) files.push_back(path.string());
    }
}

}  // namespace

std::string fingerprint(const std::string& file) {
    return file.empty() ? "" : hash_of(read_file(file));
}

std::string files_key(const std::vector<std::string>& files) {
    std::string key;
    for (const std::string& file : files) {
        const std::string bytes = read_file(file);
        key += (key.empty() ? "" : "; ") + file + ", " + std::to_string(bytes.size()) + " bytes, " +
               hash_of(bytes);
    }
    return key;
}

std::string short_key(const std::vector<std::string>& files) {
    return files.empty() ? "" : "_" + hash_of(files_key(files));
}

std::vector<std::string> garment_files(const std::string& garment) {
    std::vector<std::string> files;
    for (const std::string& part : outfit_parts(garment)) {
        const fs::path path = part;
        if (!path.has_extension() || !fs::is_regular_file(path)) continue;
        files.push_back(part);
        if (path.extension() == ".gltf") add_buffers(part, files);
        const fs::path worn = fs::path(path).replace_extension(".worn.obj");
        if (fs::is_regular_file(worn)) files.push_back(worn.string());
    }
    return files;
}

std::vector<std::string> motion_files(const std::string& motion) {
    if (!fs::is_regular_file(motion)) return {};
    return {motion};
}

std::vector<std::string> scene_files(const std::string& garment, const std::string& motion) {
    std::vector<std::string> files = garment_files(garment);
    for (const std::string& file : motion_files(motion)) files.push_back(file);
    return files;
}

std::vector<std::string> solver_files(const std::string& solver, const std::string& weights) {
    const std::string folder = weights.empty() ? asset_path("weights") : weights;
    std::vector<std::string> files;
    const auto add = [&](const std::string& in, bool all) {
        std::error_code unreadable;
        for (const auto& entry : fs::directory_iterator(in, unreadable))
            if (entry.path().extension() == ".safetensors" &&
                (all || solver.find(entry.path().stem().string()) != std::string::npos))
                files.push_back(entry.path().string());
    };
    add(folder, false);
    if (solver.rfind("skinning", 0) == 0) add(folder + "/skinning", true);
    std::sort(files.begin(), files.end());
    const size_t tilde = solver.find('~');
    if (tilde == std::string::npos) return files;
    const std::string proxy = solver.substr(tilde + 1);
    for (const std::string& file : garment_files(proxy.substr(0, proxy.find('+'))))
        files.push_back(file);
    return files;
}

}  // namespace cloth
