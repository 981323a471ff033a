#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace cloth {

/// Reads accessors of a glTF 2.0 file, which assimp does not hand on where they are custom
/// attributes. Specification: registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, section 3.6.
class GltfNumbers {
 public:
    /// @throws LoadError if the file cannot be read
    explicit GltfNumbers(std::string path);
    ~GltfNumbers();
    GltfNumbers(const GltfNumbers&) = delete;
    GltfNumbers& operator=(const GltfNumbers&) = delete;

    const nlohmann::json& root() const { return *m_root; }

    /// The numbers of an accessor, one element after the other. Normalised integers become 0 to 1.
    /// @param components  of an element: 1 for SCALAR, 3 for VEC3
    /// @param place       for messages
    /// @throws LoadError if there is no such accessor, it is of another type, sparse, of integers
    ///         that are not normalised, or its bytes are not there
    std::vector<float> read(size_t accessor, int components, const std::string& place);

    /// The whole numbers of an accessor, such as corners of faces, of 8 to 32 bits without a sign.
    /// @throws LoadError as read() does
    std::vector<std::uint32_t> read_whole(size_t accessor, int components,
                                          const std::string& place);

    /// How many elements an accessor has. @throws LoadError if there is no such accessor
    size_t count(size_t accessor, const std::string& place) const;

    /// Whether read() can read it as it is stored: neither sparsely, nor compressed, nor not at
    /// all.
    /// @throws LoadError if there is no such accessor
    bool is_plain(size_t accessor, const std::string& place) const;

    /// A number of the file that counts something or refers to something.
    /// @throws LoadError if it is not there, or is no whole number of 0 or more
    size_t index(const nlohmann::json& object, const char* key, const std::string& place) const;

 private:
    [[noreturn]] void fail(const std::string& place, const std::string& problem,
                           const std::string& remedy) const;
    const nlohmann::json& entry(const char* list, size_t number, const std::string& place) const;
    /// Where the bytes of an accessor are.
    struct Elements {
        const char* first;
        size_t count, stride;
    };
    /// @param size  of a component (bytes)
    Elements elements(const nlohmann::json& accessor, size_t size, int components,
                      const std::string& place);
    const nlohmann::json& typed_entry(size_t accessor, int components,
                                      const std::string& place) const;
    const std::string& buffer(size_t number, const std::string& place);

    std::string m_path;
    std::unique_ptr<nlohmann::json> m_root;
    std::string m_binary;  ///< of a .glb
    std::map<size_t, std::string> m_buffers;
};

/// The bytes that base64 text stands for, up to the first character that is none of its own.
std::string from_base64(const std::string& text);

}  // namespace cloth
