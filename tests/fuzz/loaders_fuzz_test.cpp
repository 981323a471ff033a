// Every file that data/ and gnn/model/ read, damaged. README.md says what must hold.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "data/authoring/garment_recipe.h"
#include "data/body/amass_motion.h"
#include "data/body/body_shapes.h"
#include "data/body/character_rig.h"
#include "data/body/motion.h"
#include "data/body/rig_recipe.h"
#include "data/body/smpl_model.h"
#include "data/core/errors.h"
#include "data/files/mesh_io.h"
#include "data/files/mhclo.h"
#include "data/files/npy_array.h"
#include "data/files/painted_mesh.h"
#include "data/files/point_cache_reader.h"
#include "gnn/model/weights.h"
#include "gnn/skinning/skinning_weights.h"
#include "tests/data/body/smpl_files.h"
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

std::string check_painted_mesh(const std::string& path) {
    const PaintedMesh painted =
        load_painted_mesh(path, "", FacesWithoutArea::refuse, GoalColours());
    if (painted.mesh.vertices.rows() == 0) return "an empty mesh";
    try {
        check(painted.limits, painted.mesh.vertices.rows(), "limits");
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "";
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

std::string check_skinning_weights(const std::string& path) {
    const SkinningWeights weights = SkinningWeights::load(path);
    for (const TensorShape& expected : tensor_shapes(weights.config))
        if (weights.tensor(expected.first).shape != expected.second) return expected.first;
    const SkinWeights skin = weights.skin({0, 1});
    if (skin.vertex_count() != weights.config.vertices) return "skin weights of other vertices";
    return weights.points("worn").allFinite() ? "" : "a place is not finite";
}

std::string check_npy(const std::string& path) {
    const NpyArray array = load_npy(path);
    if (array.is_text) return "";
    return array.size() == static_cast<std::int64_t>(array.numbers.size()) ? "" : "another size";
}

std::string check_smpl_model(const std::string& path) {
    const SmplModel model = SmplModel::load(path);
    const Eigen::Index vertices = model.mean.rows();
    if (!in_range(*model.faces, vertices)) return "a corner is out of range";
    if (model.weights->vertex_count() != vertices) return "weights of another skin";
    for (const int joint : model.weights->joints)
        if (joint < 0 || joint >= model.joint_count()) return "no such joint";
    for (int j = 0; j < model.joint_count(); ++j)
        if (model.parents[static_cast<size_t>(j)] >= j) return "a parent comes later";
    const Points rest = model.rest(VectorX::Zero(model.beta_count()));
    if (!rest.allFinite() || !model.joints(rest).allFinite()) return "a place is not finite";
    const std::vector<Eigen::Matrix3d> straight(static_cast<size_t>(model.joint_count()),
                                                Eigen::Matrix3d::Identity());
    return model.pose_offsets(straight).allFinite() ? "" : "a bend is not finite";
}

std::string check_amass_motion(const std::string& path) {
    const AmassMotion motion = AmassMotion::load(path);
    if (motion.frame_count() < 1 || motion.joint_count() < 1) return "no frames";
    if (motion.translations.rows() != motion.frame_count()) return "translations are missing";
    if (!motion.translations.allFinite()) return "a translation is not finite";
    for (const auto& rotations : motion.rotations)
        for (const Eigen::Quaterniond& rotation : rotations)
            if (!(std::abs(rotation.norm() - 1.0) < 1e-6)) return "a rotation is not one";
    return std::isfinite(motion.duration()) ? "" : "the duration is unusable";
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

std::string skinning_weights_file() {
    SkinningWeights weights;
    weights.config.garment = "patch";
    weights.config.vertices = 3;
    weights.config.joints = {"Hips", "Spine"};
    weights.config.ages = {0, 1};
    weights.config.layers = {2};
    for (const auto& [name, shape] : tensor_shapes(weights.config)) {
        const size_t count =
            static_cast<size_t>(shape[0]) * static_cast<size_t>(shape.size() > 1 ? shape[1] : 1);
        weights.tensors[name] = {shape, std::vector<float>(count, 0.5f)};
    }
    const auto path = std::filesystem::temp_directory_path() / "fuzz_sample_skinning";
    weights.save(path.string());
    const std::string bytes = read(path.string());
    std::filesystem::remove(path);
    return bytes;
}

/// Not compressed, so that what is changed is more often a number than the stream.
std::string npz_file(const std::map<std::string, std::string>& arrays) {
    const auto path = std::filesystem::temp_directory_path() / "fuzz_sample.npz";
    write_npz(path.string(), arrays, /*compressed=*/false);
    const std::string bytes = read(path.string());
    std::filesystem::remove(path);
    return bytes;
}

/// Damages each array in turn. What is damaged in the archive itself fails at its check sums.
void fuzz_arrays(const std::map<std::string, std::string>& arrays,
                 const std::function<std::string(const std::string& path)>& check) {
    for (const auto& entry : arrays) {
        const auto load = [&arrays, &check, name = entry.first](const std::string& path) {
            struct Removed {
                std::string path;
                ~Removed() { std::filesystem::remove(path); }
            };
            std::map<std::string, std::string> changed = arrays;
            changed[name] = read(path);
            const Removed archive{path + ".npz"};
            write_npz(archive.path, changed, /*compressed=*/false);
            return check(archive.path);
        };
        fuzz_files({"npy", entry.second, load, /*rounds=*/60});
    }
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

TEST(LoadersFuzz, PaintedGltf) {
    fuzz_files({"gltf", painted_gltf_file(), check_painted_mesh});
}

TEST(LoadersFuzz, PaintedBinaryGltf) {
    fuzz_files({"glb", painted_glb_file(), check_painted_mesh});
}

TEST(LoadersFuzz, PaintedPly) {
    fuzz_files({"ply", painted_ply_file(false), check_painted_mesh});
    fuzz_files({"ply", painted_ply_file(true), check_painted_mesh});
}

TEST(LoadersFuzz, ColouredObj) {
    fuzz_files({"obj", coloured_obj_file(), check_painted_mesh});
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

TEST(LoadersFuzz, SkinningWeights) {
    fuzz_files({"safetensors", skinning_weights_file(), check_skinning_weights});
}

TEST(LoadersFuzz, Npy) {
    fuzz_files({"npy", npy({2, 3}, std::vector<double>{1, 2, 3, 4, 5, 6}), check_npy});
    fuzz_files({"npy", npy("<f4", {2, 2}, std::string(16, '\1'), /*fortran=*/true), check_npy});
}

TEST(LoadersFuzz, SmplModel) {
    fuzz_files({"npz", npz_file(small_smpl_model()), check_smpl_model});
    fuzz_arrays(small_smpl_model(), check_smpl_model);
}

TEST(LoadersFuzz, AmassMotion) {
    fuzz_files({"npz", npz_file(small_amass_motion()), check_amass_motion});
    fuzz_arrays(small_amass_motion(), check_amass_motion);
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
