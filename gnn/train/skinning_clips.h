#pragma once

#include <memory>
#include <string>
#include <vector>

#include "data/body/animated_body.h"
#include "gnn/skinning/pose_features.h"
#include "gnn/train/scene_random.h"

namespace cloth {

/// Consecutive frames of a body in motion.
struct SkinningWindow {
    std::shared_ptr<const AnimatedBody> body;
    double first_time = 0.0;                        ///< of the first frame (s)
    std::vector<VectorX> features;                  ///< of each frame, see PoseFeatures
    std::vector<std::vector<SkinMatrix>> matrices;  ///< of each frame and joint of the body
};

/// The motions that a skinning network is trained on, as windows of a few frames.
class SkinningClips {
 public:
    /// @param motions  as load_motion_by_name() takes them, at least one
    /// @throws LoadError for a motion that cannot be used, ArgumentError without any
    SkinningClips(std::shared_ptr<const Body> body, const std::vector<std::string>& motions,
                  const SkinningConfig& config);

    /// Frames from `first` on; frame f is at f dt. Before frame 0 the body is at rest.
    SkinningWindow window(size_t clip, int first, int frames) const;
    /// Somewhere in a random clip; all frames of all clips are as likely.
    SkinningWindow random_window(SceneRandom& random, int frames) const;

    int frame_count() const { return m_frames; }  ///< of all clips
    int frame_count(size_t clip) const { return m_counts[clip]; }

    /// Mean and deviation of the features in random frames. Deviations below 1e-3 are set to that.
    void statistics(SceneRandom& random, int samples, VectorX& mean, VectorX& deviation) const;

 private:
    PoseFeatures m_features;
    std::vector<int> m_ages;
    double m_dt;
    std::vector<std::shared_ptr<const AnimatedBody>> m_clips;
    std::vector<int> m_counts;
    int m_frames = 0;
};

}  // namespace cloth
