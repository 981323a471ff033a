// Every file that data/ and gnn/model/ read, damaged. README.md says what must hold.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "data/authoring/garment_recipe.h"
#include "data/body/body_shapes.h"
#include "data/body/character_rig.h"
#include "data/body/motion.h"
#include "data/body/rig_recipe.h"
#include "data/core/errors.h"
#include "data/files/mesh_io.h"
#include "data/files/mhclo.h"
#include "data/files/point_cache_reader.h"
#include "gnn/model/weights.h"
#include "tests/fuzz/file_fuzzing.h"
#include "tests/fuzz/sample_files.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::test {
namespace {

std::string read(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

bool in_range(const Faces& faces, Eigen::Index vertices) {
    return faces.rows() == 0 || (faces.minCoeff() >= 0 && faces.maxCoeff() < vertices);
}

std::string check_mesh(const std::string& path) {
    const TriMesh mesh = load_mesh(path);
    if (mesh.vertices.rows() == 0 || mesh.faces.rows() == 0) return "an empty mesh";
    if (!mesh.vertices.allFinite()) return "a vertex is not finite";
    if (!in_range(mesh.faces, mesh.vertices.rows())) return "a corner is out of range";
    const Points areas = face_area_vectors(mesh.vertices, mesh.faces);
    return areas.rowwise().norm().minCoeff() > 0.0 ? "" : "a face has no area";
}

std::string check_rig(const std::string& path) {
    const CharacterRig rig = load_character_rig(path);
    if (!rig.rest.allFinite() || !in_range(rig.faces, rig.rest.rows())) return "the skin is broken";
    if (rig.weights.vertex_count() != rig.rest.rows()) return "weights of another skin";
    for (const double weight : rig.weights.values)
        if (!(weight > 0.0 && weight <= 1.0 + 1e-9)) return "a weight is not in (0, 1]";
    for (const int joint : rig.weights.joints)
        if (joint < 0 || joint >= static_cast<int>(rig.joints.size())) return "no such joint";
    for (size_t k = 0; k < rig.nodes.size(); ++k) {
        const CharacterNode& node = rig.nodes[k];
        const bool has_track = !node.track || *node.track < static_cast<int>(rig.tracks.size());
        if (node.parent >= static_cast<int>(k) || !has_track)
            return "a node refers to what comes later";
        if (!node.rest.matrix().allFinite()) return "a node is not finite";
    }
    return std::isfinite(rig.duration) && rig.duration >= 0.0 ? "" : "the duration is unusable";
}

std::string check_motion(const std::string& path) {
    const Motion motion = load_bvh(path);
    if (motion.frames.empty()) return "no frames";
    if (!motion.skeleton.offsets.allFinite()) return "an offset is not finite";
    for (int j = 0; j < motion.skeleton.joint_count(); ++j)
        if (motion.skeleton.parents[static_cast<size_t>(j)] >= j) return "a parent comes later";
    const Motion resampled = resample(motion, 30.0);
    for (const MotionFrame& frame : resampled.frames) {
        if (frame.rotations.size() != motion.skeleton.names.size()) return "rotations are missing";
        if (!frame.root_position.allFinite()) return "the root is not finite";
        for (const Eigen::Quaterniond& rotation : frame.rotations)
            if (!(std::abs(rotation.norm() - 1.0) < 1e-6)) return "a rotation is not one";
    }
    return "";
}

std::string check_point_cache(const std::string& path) {
    PointCacheReader cache(path);
    if (cache.frames() < 1 || cache.frames() > cache.announced_frames()) return "no such frames";
    for (int k = 0; k < cache.frames(); ++k) {
        const Points x = cache.frame(k);
        if (x.rows() != cache.vertices() || !x.allFinite()) return "a frame is unusable";
    }
    return "";
}

std::string check_weights(const std::string& path) {
    const Weights weights = Weights::load(path);
    for (const TensorShape& expected : parameter_shapes(weights.config))
        if (weights.tensor(expected.first).shape != expected.second) return expected.first;
    for (const auto& [name, tensor] : weights.tensors)
        for (const float value : tensor.data) {
            if (!std::isfinite(value)) return name + " is not finite";
            const bool divides = name.find("deviation") != std::string::npos;
            if (divides && !std::isfinite(1.0f / value)) return name + " cannot divide";
        }
    return "";
}

std::string check_rig_recipe(const std::string& path) {
    const RigRecipe recipe = load_rig_recipe(path);
    for (const RigPoint& point : recipe.points)
        for (const int vertex : point.vertices)
            if (vertex < 0 || vertex >= recipe.vertex_count) return "a vertex is out of range";
    for (size_t j = 0; j < recipe.joints.size(); ++j)
        if (recipe.joints[j].parent >= static_cast<int>(j)) return "a parent comes later";
    return "";
}

std::string check_garment_recipe(const std::string& path) {
    const GarmentRecipe recipe = load_garment_recipe(path);
    try {
        recipe.check();
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "";
}

std::string check_shape_target(const std::string& path) {
    const ShapeTarget target = load_shape_target(path, 20);
    for (const int vertex : target.vertices)
        if (vertex < 0 || vertex >= 20) return "a vertex is out of range";
    return target.offsets.allFinite() ? "" : "an offset is not finite";
}

std::string check_mhclo(const std::string& path) {
    const MhcloFile clothes = load_mhclo(path);
    if (clothes.rows.empty() || clothes.obj_file.empty()) return "nothing to put on";
    for (const MhcloRow& row : clothes.rows)
        if (!row.weights.allFinite() || !row.offset.allFinite()) return "a row is not finite";
    const Points base = Points::Random(20, 3);
    try {
        const Points places = clothes.places(base);
        if (places.rows() != static_cast<Eigen::Index>(clothes.rows.size())) return "rows are lost";
        if (!places.allFinite()) return "a place is not finite";
    } catch (const ArgumentError& error) {
        const std::string message = error.what();  // of another base mesh
        if (message.find("Remedy: ") == std::string::npos) return message;
    }
    return "";
}

std::string weights_file(const std::string& variant) {
    const int steps = variant == "fast" ? 1 : 3;
    ModelConfig config = ModelConfig::variant_named(variant, steps, /*levels=*/1);
    config.width = 4;
    config.hidden_layers = 1;
    const auto path = std::filesystem::temp_directory_path() / ("fuzz_sample_" + variant);
    random_weights(config).save(path.string());
    const std::string bytes = read(path.string());
    std::filesystem::remove(path);
    return bytes;
}

std::string zipped_collada_file() {
    const auto path = std::filesystem::temp_directory_path() / "fuzz_sample.zae";
    write_zipped_collada(path.string());
    const std::string bytes = read(path.string());
    std::filesystem::remove(path);
    return bytes;
}

TEST(LoadersFuzz, Obj) {
    fuzz_files({"obj", obj_file(), check_mesh});
}

TEST(LoadersFuzz, AsciiPly) {
    fuzz_files({"ply", ascii_ply_file(), check_mesh});
}

TEST(LoadersFuzz, LittleEndianPly) {
    fuzz_files({"ply", binary_ply_file(false), check_mesh});
}

TEST(LoadersFuzz, BigEndianPly) {
    fuzz_files({"ply", binary_ply_file(true), check_mesh});
}

TEST(LoadersFuzz, Gltf) {
    fuzz_files({"gltf", gltf_file(), check_mesh});
}

TEST(LoadersFuzz, BinaryGltf) {
    fuzz_files({"glb", glb_file(), check_mesh});
}

TEST(LoadersFuzz, Collada) {
    fuzz_files({"dae", collada_file(), check_mesh});
}

TEST(LoadersFuzz, ZippedCollada) {
    fuzz_files({"zae", zipped_collada_file(), check_mesh});
}

TEST(LoadersFuzz, CharacterOfGltf) {
    fuzz_files({"gltf", gltf_file(), check_rig});
}

TEST(LoadersFuzz, CharacterOfCollada) {
    fuzz_files({"dae", collada_file(), check_rig});
}

TEST(LoadersFuzz, Bvh) {
    fuzz_files({"bvh", bvh_file(), check_motion});
}

TEST(LoadersFuzz, Pc2) {
    fuzz_files({"pc2", pc2_file(), check_point_cache});
}

TEST(LoadersFuzz, Mdd) {
    fuzz_files({"mdd", mdd_file(), check_point_cache});
}

TEST(LoadersFuzz, Weights) {
    fuzz_files({"safetensors", weights_file("fast"), check_weights});
    fuzz_files({"safetensors", weights_file("hood_fast"), check_weights});
}

TEST(LoadersFuzz, RigRecipe) {
    fuzz_files({"json", rig_recipe_file(), check_rig_recipe});
}

TEST(LoadersFuzz, GarmentRecipe) {
    fuzz_files({"json", garment_recipe_file(), check_garment_recipe});
}

TEST(LoadersFuzz, Mhclo) {
    fuzz_files({"mhclo", mhclo_file(), check_mhclo});
}

TEST(LoadersFuzz, ShapeTarget) {
    fuzz_files({"target", shape_target_file(), check_shape_target});
}

}  // namespace
}  // namespace cloth::test
