#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// Joint tree of a motion capture figure. Joints are sorted so that parents come first; joint 0 is
/// the root. Zero rotations are the figure's rest pose, all joint frames parallel to the world
/// axes.
struct Skeleton {
    std::vector<std::string> names;
    std::vector<int> parents;  ///< -1 for the root
    Points offsets;            ///< |joints| x 3 (m): from the parent, in the parent's frame
    Points end_offsets;        ///< |joints| x 3 (m): to the joint's end site; zero if it has none

    int joint_count() const { return static_cast<int>(names.size()); }
    /// Index of the joint called `name`, if there is one.
    std::optional<int> find(const std::string& name) const;
};

struct MotionFrame {
    Vec3 root_position = Vec3::Zero();          ///< (m)
    std::vector<Eigen::Quaterniond> rotations;  ///< |joints|: relative to the parent
};

/// A figure and how it moves: one frame every `frame_time` seconds.
struct Motion {
    std::string name;    ///< for reports: the file's name without folder and extension
    std::string source;  ///< for errors: the file
    Skeleton skeleton;
    double frame_time = 1.0 / 30.0;  ///< (s)
    std::vector<MotionFrame> frames;

    int frame_count() const { return static_cast<int>(frames.size()); }
    /// From the first frame to the last (s).
    double duration() const { return frame_time * (frame_count() - 1); }
};

/// Many CMU conversions put a calibration pose (T-pose) before the first captured frame.
enum class FirstFrame { detect, keep, drop };

struct BvhSettings {
    double scale = 0.0;  ///< file units to metres, 0 to 1e3; 0: the one of m, cm, mm, inch and
                         ///< CMU's (0.056444 m) that makes the rest height closest to 1.6 m
    FirstFrame first_frame = FirstFrame::detect;  ///< detect: drop a T-pose that the motion leaves
                                                  ///< in one jump
};

/// Reads a BVH file.
/// @throws LoadError naming the line if the file is truncated, empty, has unknown keywords or
///         channels, rows of the wrong length or numbers that are not finite
Motion load_bvh(const std::string& path, const BvhSettings& settings = {});

/// The same motion at `fps` frames per second: spherical interpolation between frames.
Motion resample(const Motion& motion, double fps);

/// World rotations (|joints|) of one frame.
std::vector<Eigen::Quaterniond> world_rotations(const Skeleton& skeleton, const MotionFrame& frame);

/// World positions (|joints| x 3, m) of the joints in one frame.
Points joint_positions(const Skeleton& skeleton, const MotionFrame& frame);

/// A motion by its CMU number ("01_01"), file name or path, at 30 Hz. Looked for in this order:
///  1. an existing path that ends with .bvh, in capitals or not;
///  2. the clips of assimp-testmodels: 01_01 (the part of the capture with steady motion: frames 38
///     to 261 at 30 Hz), 01_03 and Boxing_Toes;
///  3. the shared data folder, motions/train and motions/validation: NAME.bvh, or NAME_*.bvh if
///     there is one;
///  4. any other existing path, whose file is read as BVH.
/// @throws LoadError listing the known names, or those that begin with NAME_ if there are several
Motion load_motion_by_name(const std::string& name);

/// Paths of the BVH files of a folder, sorted by name.
std::vector<std::string> list_motions(const std::string& folder);

}  // namespace cloth
