#include "tests/fuzz/sample_files.h"

#include <zip.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

namespace cloth::test {

std::string obj_file() {
    return "# two pieces\nmtllib none.mtl\no quad\nv 0.1 0 0\nv 1 0 0\nv 1 1 0.25\nv 0 1 0\n"
           "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl red\ns off\nf 1/1/1 2/2/1 3/3/1 4/1/1\n"
           "o prism\nv 2 0 0\nv 3 0 0\nv 2.5 1.5e0 -1\nv 2.5 0.5 1\ng side\nf 5 6 7\nf -4//1 -2//1 "
           "-1//1\nf 6 8 7\n";
}

namespace {

constexpr float strip_positions[6][3] = {{0, 0, 0}, {1, 0, 0},  {0, 1, 0},
                                         {1, 1, 0}, {0, 2, .5}, {1, 2, .5}};
constexpr int strip_faces[4][3] = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};

std::string ply_header(const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment a strip\nelement vertex 6\nproperty float x\nproperty float y\n"
           "property float z\nproperty uchar red\nelement face 4\n"
           "property list uchar int vertex_indices\nend_header\n";
}

template <typename Number>
void append(std::string& bytes, Number number, bool big_endian = false) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    if (big_endian) std::reverse(std::begin(raw), std::end(raw));
    bytes.append(raw, sizeof number);
}

}  // namespace

std::string ascii_ply_file() {
    std::string text = ply_header("ascii");
    for (const auto& p : strip_positions)
        text += std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) +
                " 255\n";
    for (const auto& f : strip_faces)
        text += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " +
                std::to_string(f[2]) + "\n";
    return text;
}

std::string painted_ply_file(bool big_endian) {
    std::string bytes = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian");
    const std::string red = "property uchar red\n";
    bytes.replace(bytes.find(red), red.size(),
                  "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                  "property float max_distance\nproperty ushort drive_damping\n");
    for (int i = 0; i < 6; ++i) {
        for (const float coordinate : strip_positions[i]) append(bytes, coordinate, big_endian);
        for (int channel = 0; channel < 3; ++channel) append(bytes, std::uint8_t{200});
        append(bytes, 0.05f * static_cast<float>(i), big_endian);
        append(bytes, static_cast<std::uint16_t>(i), big_endian);
    }
    for (const auto& f : strip_faces) {
        append(bytes, std::uint8_t{3});
        for (const int corner : f) append(bytes, std::int32_t{corner}, big_endian);
    }
    return bytes;
}

std::string coloured_obj_file() {
    return "v 0.1 0 0 1 1 1\nv 1 0 0 0.5 0.5 0\nv 1 1 0.25 0 0 1\nv 0 1 0 0.2 1 1\n"
           "f 1 2 3 4\n";
}

std::string binary_ply_file(bool big_endian) {
    std::string bytes = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian");
    for (const auto& p : strip_positions) {
        for (const float coordinate : p) append(bytes, coordinate, big_endian);
        append(bytes, std::uint8_t{255});
    }
    for (const auto& f : strip_faces) {
        append(bytes, std::uint8_t{3});
        for (const int corner : f) append(bytes, std::int32_t{corner}, big_endian);
    }
    return bytes;
}

namespace {

std::string cache_frames(bool big_endian) {
    std::string bytes;
    for (int i = 0; i < 3 * 2 * 3; ++i) append(bytes, 0.25f * static_cast<float>(i), big_endian);
    return bytes;
}

}  // namespace

std::string pc2_file() {
    std::string bytes("POINTCACHE2", 12);
    for (const std::int32_t count : {1, 2}) append(bytes, count);  // version, vertices
    for (const float number : {0.0f, 1.0f}) append(bytes, number);
    append(bytes, std::int32_t{3});
    return bytes + cache_frames(false);
}

std::string mdd_file() {
    std::string bytes;
    for (const std::int32_t count : {3, 2}) append(bytes, count, true);  // frames, vertices
    for (const float time : {0.0f, 0.04f, 0.08f}) append(bytes, time, true);
    return bytes + cache_frames(true);
}

namespace {

/// The numbers of the glTF file, view by view; every view starts at a multiple of four.
struct GltfNumbers {
    std::string bytes;
    std::vector<size_t> begins;

    void begin_view() {
        bytes.resize((bytes.size() + 3) / 4 * 4);
        begins.push_back(bytes.size());
    }
    void floats(const std::vector<float>& numbers) {
        begin_view();
        for (const float number : numbers) append(bytes, number);
    }
};

GltfNumbers strip_numbers() {
    GltfNumbers numbers;
    numbers.begin_view();  // 0: indices
    for (const auto& f : strip_faces)
        for (const int corner : f) append(numbers.bytes, static_cast<std::uint16_t>(corner));
    numbers.begin_view();  // 1: positions
    for (const auto& p : strip_positions)
        for (const float coordinate : p) append(numbers.bytes, coordinate);
    numbers.begin_view();  // 2: joints
    for (int i = 0; i < 6; ++i)
        for (const int joint : {0, 1, 0, 0})
            append(numbers.bytes, static_cast<std::uint8_t>(joint));
    std::vector<float> weights;  // 3
    for (int i = 0; i < 6; ++i) {
        const float upper = 0.5f * static_cast<float>(i / 2);
        weights.insert(weights.end(), {1.0f - upper, upper, 0.0f, 0.0f});
    }
    numbers.floats(weights);
    numbers.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,    // 4: inverse binding
                    1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});  // matrices
    numbers.floats({0.0f, 0.5f, 1.0f});                                 // 5: times
    numbers.floats({0, 0, 0, 1, 0, 0, 0.38268f, 0.92388f, 0, 0, 0.70711f, 0.70711f});  // 6
    return numbers;
}

std::string view(const GltfNumbers& numbers, size_t k) {
    const size_t end = k + 1 < numbers.begins.size() ? numbers.begins[k + 1] : numbers.bytes.size();
    return "{\"buffer\":0,\"byteOffset\":" + std::to_string(numbers.begins[k]) +
           ",\"byteLength\":" + std::to_string(end - numbers.begins[k]) + "}";
}

std::string accessor(int buffer_view, int component, int count, const std::string& type,
                     const std::string& more = "") {
    return "{\"bufferView\":" + std::to_string(buffer_view) +
           ",\"byteOffset\":0,\"componentType\":" + std::to_string(component) +
           ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"" + more + "}";
}

/// With limits of goals if the numbers have them.
std::string gltf_json(const GltfNumbers& numbers, const std::string& uri) {
    const bool is_painted = numbers.begins.size() > 7;
    std::string views;
    for (size_t k = 0; k < numbers.begins.size(); ++k)
        views += (k > 0 ? ",\n" : "") + view(numbers, k);
    return std::string(
               "{\"asset\":{\"version\":\"2.0\"},\n\"scene\":0,\n\"scenes\":[{\"nodes\":[0]}],\n"
               "\"nodes\":[{\"name\":\"strip\",\"mesh\":0,\"skin\":0,\"children\":[1]},\n"
               "{\"name\":\"lower\",\"children\":[2]},{\"name\":\"upper\",\"translation\":[0,1,0]}]"
               ",\n"
               "\"meshes\":[{\"name\":\"strip\",\"primitives\":[{\"attributes\":{\"POSITION\":1,"
               "\"JOINTS_0\":2,\"WEIGHTS_0\":3") +
           (is_painted ? ",\"_MAX_DISTANCE\":7,\"_DRIVE_DAMPING\":8" : "") +
           "},\"indices\":0}]}],\n"
           "\"skins\":[{\"inverseBindMatrices\":4,\"joints\":[1,2]}],\n"
           "\"animations\":[{\"name\":\"bend\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":2,"
           "\"path\":\"rotation\"}}],\"samplers\":[{\"input\":5,\"interpolation\":\"LINEAR\","
           "\"output\":6}]}],\n\"buffers\":[{" +
           (uri.empty() ? "" : "\"uri\":\"" + uri + "\",") +
           "\"byteLength\":" + std::to_string(numbers.bytes.size()) + "}],\n\"bufferViews\":[" +
           views + "],\n\"accessors\":[" + accessor(0, 5123, 12, "SCALAR") + ",\n" +
           accessor(1, 5126, 6, "VEC3", ",\"max\":[1,2,0.5],\"min\":[0,0,0]") + ",\n" +
           accessor(2, 5121, 6, "VEC4") + ",\n" + accessor(3, 5126, 6, "VEC4") + ",\n" +
           accessor(4, 5126, 2, "MAT4") + ",\n" +
           accessor(5, 5126, 3, "SCALAR", ",\"max\":[1],\"min\":[0]") + ",\n" +
           accessor(6, 5126, 3, "VEC4") +
           (is_painted ? ",\n" + accessor(7, 5126, 6, "SCALAR") + ",\n" +
                             accessor(8, 5121, 6, "SCALAR", ",\"normalized\":true")
                       : "") +
           "]}\n";
}

std::string base64(const std::string& bytes) {
    static const char* const letters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t at = 0; at < bytes.size(); at += 3) {
        unsigned group = 0;
        for (size_t k = 0; k < 3; ++k)
            group = group << 8 |
                    (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += at + k <= bytes.size() ? letters[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

GltfNumbers painted_numbers() {
    GltfNumbers numbers = strip_numbers();
    numbers.floats({0.0f, 0.0f, 0.05f, 0.05f, 0.1f, 0.2f});  // 7: largest distances
    numbers.begin_view();                                    // 8: drives
    for (int i = 0; i < 6; ++i) append(numbers.bytes, static_cast<std::uint8_t>(40 * i));
    return numbers;
}

std::string gltf_of(const GltfNumbers& numbers) {
    return gltf_json(numbers, "data:application/octet-stream;base64," + base64(numbers.bytes));
}

std::string glb_of(GltfNumbers numbers) {
    std::string json = gltf_json(numbers, "");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    numbers.bytes.resize((numbers.bytes.size() + 3) / 4 * 4);
    std::string file = "glTF";
    append(file, std::uint32_t{2});
    append(file, static_cast<std::uint32_t>(28 + json.size() + numbers.bytes.size()));
    append(file, static_cast<std::uint32_t>(json.size()));
    file += "JSON" + json;
    append(file, static_cast<std::uint32_t>(numbers.bytes.size()));
    file += std::string("BIN\0", 4) + numbers.bytes;
    return file;
}

}  // namespace

std::string gltf_file() {
    return gltf_of(strip_numbers());
}

std::string glb_file() {
    return glb_of(strip_numbers());
}

std::string painted_gltf_file() {
    return gltf_of(painted_numbers());
}

std::string painted_glb_file() {
    return glb_of(painted_numbers());
}

std::string collada_file() {
    return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
 <library_geometries><geometry id="strip" name="strip"><mesh>
  <source id="p"><float_array id="pa" count="18">0 0 0 100 0 0 0 100 0 100 100 0 0 200 50 100 200 50
   </float_array><technique_common><accessor source="#pa" count="6" stride="3">
   <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
  </accessor></technique_common></source>
  <source id="n"><float_array id="na" count="3">0 0 1</float_array>
   <technique_common><accessor source="#na" count="1" stride="3"><param name="X" type="float"/>
   <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <polylist count="3" material="none"><input semantic="VERTEX" source="#v" offset="0"/>
   <input semantic="NORMAL" source="#n" offset="1"/><vcount>4 3 3</vcount>
   <p>0 0 1 0 3 0 2 0 2 0 3 0 5 0 2 0 5 0 4 0</p></polylist>
 </mesh></geometry></library_geometries>
 <library_animations><animation id="turn">
  <source id="t"><float_array id="ta" count="2">0 1.5</float_array><technique_common>
   <accessor source="#ta" count="2" stride="1"><param name="TIME" type="float"/></accessor>
  </technique_common></source>
  <source id="o"><float_array id="oa" count="2">0 90</float_array><technique_common>
   <accessor source="#oa" count="2" stride="1"><param name="ANGLE" type="float"/></accessor>
  </technique_common></source>
  <sampler id="s"><input semantic="INPUT" source="#t"/><input semantic="OUTPUT" source="#o"/>
  </sampler><channel source="#s" target="child/rotateZ.ANGLE"/>
 </animation></library_animations>
 <library_visual_scenes><visual_scene id="scene">
  <node id="parent" name="parent"><translate>0 0 10</translate><node id="child" name="child">
   <rotate sid="rotateZ">0 0 1 0</rotate><instance_geometry url="#strip"/></node></node>
 </visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
)";
}

void write_zipped_collada(const std::string& path) {
    const std::string text = collada_file();
    const zipFile archive = zipOpen(path.c_str(), APPEND_STATUS_CREATE);
    if (!archive) throw std::runtime_error(path + ": cannot be written");
    zip_fileinfo info{};
    zipOpenNewFileInZip(archive, "strip.dae", &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                        Z_DEFAULT_COMPRESSION);
    zipWriteInFileInZip(archive, text.data(), static_cast<unsigned>(text.size()));
    zipCloseFileInZip(archive);
    zipClose(archive, nullptr);
}

std::string bvh_file() {
    return "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0 0\n  CHANNELS 6 Xposition Yposition Zposition "
           "Zrotation Xrotation Yrotation\n  JOINT Spine\n  {\n    OFFSET 0 5.5 0.1\n    CHANNELS "
           "3 "
           "Zrotation Xrotation Yrotation\n    JOINT Head\n    {\n      OFFSET 0 8 0\n      "
           "CHANNELS 3 Zrotation Xrotation Yrotation\n      End Site\n      {\n        OFFSET 0 "
           "1.5 "
           "0\n      }\n    }\n  }\n  JOINT Leg\n  {\n    OFFSET 1.7 -1.8 0\n    CHANNELS 3 "
           "Zrotation Xrotation Yrotation\n    End Site\n    {\n      OFFSET 0 -14 0\n    }\n  "
           "}\n}\n"
           "MOTION\nFrames: 4\nFrame Time: 0.0083333\n"
           "0 17 0 0 0 0 0 0 0 0 0 0 0 0 0\n9 17.1 -1 60 5 1 2 3 4 5 6 7 -30 20 10\n"
           "9.1 17 -1 61 5 1 2.1 3 4 5 6 7 -31 20 10\n9.2 17.1 -1e0 62 5 1 2.2 3 4 5 6 7 -33 21 "
           "9\n";
}

std::string garment_recipe_file() {
    return "{\n \"about\": \"a T-shirt\",\n \"target_vertices\": 4000,\n"
           " \"from\": \"shoulders\", \"to\": \"hem\", \"sleeve_length\": 0.5, \"flare\": 0.25,\n"
           " \"shoulder\": [0.158, 1.325, 0.012],\n \"neck\": [0.0, 1.383, 0.0242],\n"
           " \"neck_tilt\": 29.0,\n \"hem_height\": 0.81,\n \"clearance\": 0.0045\n}\n";
}

std::string rig_recipe_file() {
    return "{\"mesh\": {\"file\": \"a.dae\", \"name\": \"skin\", \"vertices\": 20},\n"
           " \"points\": {\"hip\": {\"vertices\": [1, 2, 19], \"weights\": [0.5, 0.25, 0.25]},\n"
           "  \"knee\": {\"vertices\": [3], \"weights\": [1.0]},\n"
           "  \"foot\": {\"vertices\": [7, 8], \"weights\": [0.4, 0.6]}},\n"
           " \"joints\": [{\"name\": \"Hip\", \"parent\": null, \"point\": \"hip\"},\n"
           "  {\"name\": \"Knee\", \"parent\": \"Hip\", \"point\": \"knee\"}],\n"
           " \"bones\": [{\"joint\": \"Hip\", \"from\": \"hip\", \"to\": \"knee\"},\n"
           "  {\"joint\": \"Knee\", \"from\": \"knee\", \"to\": \"foot\"}]}\n";
}

std::string shape_target_file() {
    return "# a target\n0 .001 -.02 0.5\n7 1e-3 0 0\n19 0 0.25 -1.5\n";
}

std::string mhclo_file() {
    return "# clothes\n\nuuid 1-2\nbasemesh hm08\nname patch\nobj_file patch.obj\n"
           "x_scale 5 11 1.5\ny_scale 7 8 2.25\nz_scale 9 5 1e0\nz_depth 50\nverts 0\n"
           "0 1 2 0.5 0.25 .25 0.01 -0.02 0.03\n3 4 5 .2 0.3 0.5 0 0 -1.5e-2\n7\n"
           "10 11 12 1.5 -0.25 -0.25 0 0 0\n19\n\ndelete_verts\n5 - 9 12\n";
}

}  // namespace cloth::test
