#pragma once

#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// A motion as the archive AMASS has it (Mahmood et al., *AMASS: Archive of Motion Capture as
/// Surface Shapes*, ICCV 2019), turned so that y is up. Its motions are not free to hand on: they
/// are to be had from its authors.
struct AmassMotion {
    double frame_time = 1.0 / 120.0;                         ///< (s)
    std::vector<std::vector<Eigen::Quaterniond>> rotations;  ///< |frames| x |joints|: relative to
                                                             ///< the parent; the first is the root
    Points translations;                                     ///< |frames| x 3 (m)
    VectorX betas;                                           ///< shape of the person
    std::string gender;  ///< of the model that fits: "female", "male" or "neutral"; empty: not said

    int frame_count() const { return static_cast<int>(rotations.size()); }
    int joint_count() const { return static_cast<int>(rotations.front().size()); }
    /// From the first frame to the last (s).
    double duration() const { return frame_time * (frame_count() - 1); }

    /// Reads an .npz with poses (N x 3 J: an axis times an angle for each joint), trans (N x 3) and
    /// mocap_framerate or mocap_frame_rate; and, if they are there, betas and gender.
    /// @throws LoadError naming file, array and problem
    static AmassMotion load(const std::string& path);
};

}  // namespace cloth
