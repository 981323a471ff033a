#include "data/files/glb_writer.h"

#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "data/core/errors.h"
#include "data/files/cache_format.h"
#include "data/files/point_cache_reader.h"

namespace cloth {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// of the glTF 2.0 specification, sections 4 and 5
constexpr std::uint32_t magic = 0x46546c67, version = 2, json_chunk = 0x4e4f534a,
                        binary_chunk = 0x004e4942;
constexpr int floats = 5126, unsigned_ints = 5125, array_buffer = 34962, index_buffer = 34963;
constexpr std::uint64_t chunk_headers = 12 + 8 + 8;

/// Where things are in the binary part (bytes).
struct Layout {
    std::uint64_t indices, frames, frame, times, weights, end;

    Layout(Eigen::Index vertices, Eigen::Index faces, int count) {
        const auto n = static_cast<std::uint64_t>(count);
        indices = 0;
        frames = static_cast<std::uint64_t>(faces) * 12;
        frame = static_cast<std::uint64_t>(vertices) * 24;  // places, then normals
        times = frames + n * frame;
        weights = times + n * 4;
        end = weights + (n - 1) * n * 4;
    }
};

/// Lowest and highest coordinates of an array of places, which glTF asks for.
struct Extent {
    Eigen::RowVector3f low, high;
};

std::vector<float> row_of(const Eigen::RowVector3f& v) {
    return {v[0], v[1], v[2]};
}

/// {value} in braces is a list to GCC and a copy of the value to clang.
json list_of(const json& value) {
    return json::array({value});
}

json accessor(int view, std::uint64_t offset, int type, const char* shape, std::uint64_t count) {
    return {{"bufferView", view},
            {"byteOffset", offset},
            {"componentType", type},
            {"type", shape},
            {"count", count}};
}

/// A file of floats in order, with places and normals of each frame: of the first one themselves,
/// of the others how they differ from it.
class FrameReader {
 public:
    FrameReader(const std::string& path, const Faces& faces) : m_cache(path), m_faces(faces) {
        const Points x = m_cache.frame(0);
        m_x = x.cast<float>();
        m_normals = vertex_normals(x, m_faces).cast<float>();
    }

    using Array = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

    void read(int frame, Array& places, Array& normals) {
        places = m_x;
        normals = m_normals;
        if (frame == 0) return;
        const Points x = m_cache.frame(frame);
        places = x.cast<float>() - m_x;
        normals = vertex_normals(x, m_faces).cast<float>() - m_normals;
    }

 private:
    PointCacheReader m_cache;
    const Faces& m_faces;
    Array m_x, m_normals;
};

std::string name_of(const std::string& path) {
    return fs::path(path).stem().string();
}

json scene(const std::string& name, const Layout& at, Eigen::Index vertices, Eigen::Index faces,
           const std::vector<Extent>& extents, double rate) {
    const auto count = static_cast<int>(extents.size());
    const auto vertex_count = static_cast<std::uint64_t>(vertices);
    json accessors =
        list_of(accessor(0, 0, unsigned_ints, "SCALAR", static_cast<std::uint64_t>(faces) * 3));
    json targets = json::array();
    for (int k = 0; k < count; ++k) {
        const std::uint64_t begin = static_cast<std::uint64_t>(k) * at.frame;
        json places = accessor(1, begin, floats, "VEC3", vertex_count);
        places["min"] = row_of(extents[static_cast<size_t>(k)].low);
        places["max"] = row_of(extents[static_cast<size_t>(k)].high);
        const int index = static_cast<int>(accessors.size());
        accessors.push_back(places);
        accessors.push_back(accessor(1, begin + at.frame / 2, floats, "VEC3", vertex_count));
        if (k > 0) targets.push_back({{"POSITION", index}, {"NORMAL", index + 1}});
    }
    json primitive = {
        {"attributes", {{"POSITION", 1}, {"NORMAL", 2}}}, {"indices", 0}, {"material", 0}};
    json mesh = {{"name", name}};
    const json indices = {{"buffer", 0},
                          {"byteOffset", at.indices},
                          {"byteLength", at.frames - at.indices},
                          {"target", index_buffer}};
    const json vectors = {{"buffer", 0},
                          {"byteOffset", at.frames},
                          {"byteLength", at.times - at.frames},
                          {"byteStride", 12},
                          {"target", array_buffer}};
    json views = json::array({indices, vectors});
    json file = {{"asset", {{"version", "2.0"}, {"generator", "FastCloth"}}},
                 {"scene", 0},
                 {"scenes", list_of({{"nodes", json::array({0})}})},
                 {"nodes", list_of({{"mesh", 0}, {"name", name}})},
                 {"materials", list_of({{"name", name}, {"doubleSided", true}})},
                 {"buffers", list_of({{"byteLength", at.end}})}};
    if (count > 1) {
        primitive["targets"] = targets;
        mesh["weights"] = std::vector<float>(static_cast<size_t>(count - 1), 0.0f);
        views.push_back(
            {{"buffer", 0}, {"byteOffset", at.times}, {"byteLength", at.end - at.times}});
        const int input = static_cast<int>(accessors.size());
        json times = accessor(2, 0, floats, "SCALAR", static_cast<std::uint64_t>(count));
        times["min"] = list_of(0.0f);
        times["max"] = list_of(static_cast<float>((count - 1) / rate));
        accessors.push_back(times);
        accessors.push_back(
            accessor(2, at.weights - at.times, floats, "SCALAR",
                     static_cast<std::uint64_t>(count) * static_cast<std::uint64_t>(count - 1)));
        const json sampler = {{"input", input}, {"output", input + 1}, {"interpolation", "LINEAR"}};
        const json channel = {{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}};
        file["animations"] = list_of(
            {{"name", name}, {"samplers", list_of(sampler)}, {"channels", list_of(channel)}});
    }
    mesh["primitives"] = list_of(primitive);
    file["meshes"] = list_of(mesh);
    file["accessors"] = accessors;
    file["bufferViews"] = views;
    return file;
}

/// Bytes, written to a temporary file.
class Output {
 public:
    explicit Output(const std::string& path)
        : m_path(path), m_temporary(path + ".tmp"), m_file(std::fopen(m_temporary.c_str(), "wb")) {
        if (!m_file) fail();
    }
    ~Output() {
        if (!m_file) return;
        std::fclose(m_file);
        std::error_code ignored;
        fs::remove(m_temporary, ignored);
    }
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;

    void write(const std::string& bytes) {
        if (std::fwrite(bytes.data(), 1, bytes.size(), m_file) != bytes.size()) fail();
    }
    void commit() {
        const bool closed = std::fclose(m_file) == 0;
        m_file = nullptr;
        std::error_code error;
        if (closed) fs::rename(m_temporary, m_path, error);
        if (!closed || error) fail();
    }

 private:
    [[noreturn]] void fail() const {
        throw LoadError(
            m_path, "", "cannot be written",
            "check that the folder may be written to and has space; the frames are in " +
                unfinished_cache(m_path));
    }

    std::string m_path, m_temporary;
    std::FILE* m_file;
};

std::string bytes_of(std::initializer_list<std::uint32_t> numbers) {
    std::string bytes;
    for (const std::uint32_t number : numbers) append_number(bytes, number, ByteOrder::little);
    return bytes;
}

void append(std::string& bytes, const FrameReader::Array& array) {
    for (Eigen::Index i = 0; i < array.size(); ++i)
        append_number(bytes, array.data()[i], ByteOrder::little);
}

/// The point cache that has the frames until the end, before it is begun.
std::string frames_path(const std::string& path, const TriMesh& mesh,
                        const CacheSettings& settings) {
    const char* const remedy = "bake fewer, or to .pc2";
    if (settings.frames > GlbWriter::max_frames)
        throw ArgumentError(path,
                            "has " + std::to_string(settings.frames) +
                                " frames; a .glb has at most " +
                                std::to_string(GlbWriter::max_frames),
                            remedy);
    const Layout at(mesh.vertices.rows(), mesh.faces.rows(), settings.frames);
    constexpr std::uint64_t for_json = std::uint64_t{1} << 22;  // 4 kB a frame: more than enough
    if (at.end + for_json > std::numeric_limits<std::uint32_t>::max())
        throw ArgumentError(path, "would be larger than 4 GiB, which is all a .glb can be", remedy);
    return path + ".pc2";
}

}  // namespace

GlbWriter::GlbWriter(const std::string& path, const TriMesh& mesh, const CacheSettings& settings,
                     CacheStart start)
    : CacheWriter(path, mesh.vertices.rows(), settings),
      m_faces(mesh.faces),
      m_frames(frames_path(path, mesh, settings), mesh.vertices.rows(), settings, start) {
}

void GlbWriter::commit() {
    const std::string unfinished = unfinished_cache(path());
    FrameReader frames(unfinished, m_faces);
    const int count = settings().frames;
    std::vector<Extent> extents;
    FrameReader::Array places, normals;
    for (int k = 0; k < count; ++k) {
        frames.read(k, places, normals);
        extents.push_back({places.colwise().minCoeff(), places.colwise().maxCoeff()});
    }
    const Layout at(places.rows(), m_faces.rows(), count);
    std::string text =
        scene(name_of(path()), at, places.rows(), m_faces.rows(), extents, settings().rate).dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto text_size = static_cast<std::uint32_t>(text.size());
    const auto binary_size = static_cast<std::uint32_t>(at.end);
    Output out(path());
    out.write(bytes_of({magic, version,
                        static_cast<std::uint32_t>(chunk_headers + text_size + binary_size),
                        text_size, json_chunk}));
    out.write(text);
    out.write(bytes_of({binary_size, binary_chunk}));
    std::string bytes;
    for (Eigen::Index i = 0; i < m_faces.size(); ++i)
        append_number(bytes, static_cast<std::uint32_t>(m_faces.data()[i]), ByteOrder::little);
    out.write(bytes);
    for (int k = 0; k < count; ++k) {
        frames.read(k, places, normals);
        bytes.clear();
        append(bytes, places);
        append(bytes, normals);
        out.write(bytes);
    }
    bytes.clear();
    for (int k = 0; k < count; ++k)
        append_number(bytes, static_cast<float>(k / settings().rate), ByteOrder::little);
    for (int k = 0; k < count; ++k)
        for (int target = 1; target < count; ++target)
            append_number(bytes, k == target ? 1.0f : 0.0f, ByteOrder::little);
    out.write(bytes);
    out.commit();
    std::error_code ignored;
    fs::remove(unfinished, ignored);
}

}  // namespace cloth
