#include "data/body/motion.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/vertex_order.h"

namespace cloth {

namespace {

namespace fs = std::filesystem;

constexpr double default_fps = 30.0;

/// A clip of assimp-testmodels, cut to frames [first, first + count) of 30 Hz; count 0: to the end.
struct ModelClip {
    const char* name;
    const char* path;
    int first, count;
};

constexpr ModelClip model_clips[] = {{"01_01", "BVH/01_01.bvh", 38, 224},
                                     {"01_03", "BVH/01_03.bvh", 0, 0},
                                     {"Boxing_Toes", "BVH/Boxing_Toes.bvh", 0, 0}};

Motion cut(Motion motion, int first, int count) {
    const int last = std::min(first + count, motion.frame_count());
    motion.frames.assign(motion.frames.begin() + first, motion.frames.begin() + last);
    return motion;
}

Motion load_model_clip(const ModelClip& clip) {
    Motion motion = resample(load_bvh(model_path(clip.path)), default_fps);
    return clip.count > 0 ? cut(std::move(motion), clip.first, clip.count) : motion;
}

std::vector<std::string> shared_motions() {
    std::vector<std::string> paths;
    for (const char* folder : {"motions/train", "motions/validation"})
        if (const auto path = shared_data_path(folder))
            for (const std::string& file : list_motions(*path)) paths.push_back(file);
    return paths;
}

bool is_bvh(const std::string& path) {
    return extension_of(path) == "bvh";
}

/// The file NAME.bvh, or the one NAME_*.bvh there is; empty: none.
std::string file_named(const std::vector<std::string>& shared, const std::string& name) {
    std::vector<std::string> fits;
    for (const std::string& path : shared) {
        const std::string stem = fs::path(path).stem().string();
        if (stem == name) return path;
        if (stem.rfind(name + "_", 0) == 0) fits.push_back(path);
    }
    if (fits.size() < 2) return fits.empty() ? "" : fits.front();
    std::string names;
    for (const std::string& path : fits) names += " " + fs::path(path).stem().string();
    throw LoadError(name, "", "several motions are called so", "give one of:" + names);
}

std::string known_names(const std::vector<std::string>& shared) {
    std::string names;
    for (const ModelClip& clip : model_clips) names += std::string(" ") + clip.name;
    for (const std::string& path : shared) names += " " + fs::path(path).stem().string();
    return names;
}

MotionFrame interpolate(const MotionFrame& a, const MotionFrame& b, double s) {
    MotionFrame frame;
    frame.root_position = (1.0 - s) * a.root_position + s * b.root_position;
    frame.rotations.reserve(a.rotations.size());
    for (size_t j = 0; j < a.rotations.size(); ++j)
        frame.rotations.push_back(a.rotations[j].slerp(s, b.rotations[j]));
    return frame;
}

}  // namespace

std::optional<int> Skeleton::find(const std::string& name) const {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) return std::nullopt;
    return static_cast<int>(it - names.begin());
}

Motion resample(const Motion& motion, double fps) {
    if (!(fps > 0.0)) throw ArgumentError("fps", "is not positive", "ask for frames per second");
    Motion result{motion.name, motion.source, motion.skeleton, 1.0 / fps, {}};
    // The header's frame time is rounded (0.0083333 s), hence the slack for the last frame.
    const int count = static_cast<int>(std::floor(motion.duration() * fps + 1e-3)) + 1;
    const int last = motion.frame_count() - 1;
    for (int k = 0; k < count; ++k) {
        const double at = std::min(k / fps / motion.frame_time, static_cast<double>(last));
        const int a = static_cast<int>(at);
        const int b = std::min(a + 1, last);
        result.frames.push_back(interpolate(motion.frames[a], motion.frames[b], at - a));
    }
    return result;
}

std::vector<Eigen::Quaterniond> world_rotations(const Skeleton& skeleton,
                                                const MotionFrame& frame) {
    std::vector<Eigen::Quaterniond> world = frame.rotations;
    for (int j = 0; j < skeleton.joint_count(); ++j)
        if (skeleton.parents[j] >= 0) world[j] = world[skeleton.parents[j]] * frame.rotations[j];
    return world;
}

Points joint_positions(const Skeleton& skeleton, const MotionFrame& frame) {
    const std::vector<Eigen::Quaterniond> world = world_rotations(skeleton, frame);
    Points positions(skeleton.joint_count(), 3);
    for (int j = 0; j < skeleton.joint_count(); ++j) {
        const int parent = skeleton.parents[j];
        if (parent < 0) {
            positions.row(j) = frame.root_position;
        } else {
            const Vec3 offset = skeleton.offsets.row(j);
            positions.row(j) = positions.row(parent) + (world[parent] * offset).transpose();
        }
    }
    return positions;
}

Motion load_motion_by_name(const std::string& name) {
    std::error_code none;
    const bool is_there = fs::exists(name, none);
    if (is_there && is_bvh(name)) return resample(load_bvh(name), default_fps);
    for (const ModelClip& clip : model_clips)
        if (name == clip.name) return load_model_clip(clip);
    const std::vector<std::string> shared = shared_motions();
    const std::string found = file_named(shared, name);
    if (!found.empty()) return resample(load_bvh(found), default_fps);
    if (is_there) return resample(load_bvh(name), default_fps);
    throw LoadError(name, "", "no motion of that name",
                    "give the path of a BVH file or one of:" + known_names(shared));
}

std::vector<std::string> list_motions(const std::string& folder) {
    if (!fs::is_directory(folder))
        throw LoadError(folder, "", "is not a folder", "name a folder of BVH files");
    std::vector<std::string> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (is_bvh(entry.path().string())) paths.push_back(entry.path().string());
    std::sort(paths.begin(), paths.end());
    return paths;
}

}  // namespace cloth
