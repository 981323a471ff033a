#include "gnn/train/skinning_clips.h"

#include <algorithm>

#include "data/core/errors.h"

namespace cloth {

SkinningClips::SkinningClips(std::shared_ptr<const Body> body,
                             const std::vector<std::string>& motions, const SkinningConfig& config)
    : m_features(config, *body), m_ages(config.ages), m_dt(config.dt) {
    for (const std::string& name : motions) {
        m_clips.push_back(std::make_shared<const AnimatedBody>(body, load_motion_by_name(name)));
        m_counts.push_back(m_clips.back()->frame_count(m_dt));
        m_frames += m_counts.back();
    }
    if (m_frames == 0) throw ArgumentError("motions", "there are none", "name at least one");
}

SkinningWindow SkinningClips::window(size_t clip, int first, int frames) const {
    SkinningWindow window;
    window.body = m_clips[clip];
    window.first_time = first * m_dt;
    std::vector<SeenPose> seen;  // from the oldest that the first frame sees on
    const int oldest = first - m_ages.back();
    for (int frame = oldest; frame < first + frames; ++frame) {
        std::vector<SkinMatrix> matrices = window.body->skin_matrices(std::max(0, frame) * m_dt);
        seen.push_back(m_features.see(matrices));
        if (frame >= first) window.matrices.push_back(std::move(matrices));
    }
    for (int frame = first; frame < first + frames; ++frame) {
        std::vector<const SeenPose*> poses;
        for (const int age : m_ages)
            poses.push_back(&seen[static_cast<size_t>(frame - age - oldest)]);
        window.features.emplace_back();
        m_features.build(poses, Boundary().gravity, window.features.back());
    }
    return window;
}

SkinningWindow SkinningClips::random_window(SceneRandom& random, int frames) const {
    int at = random.below(m_frames);
    size_t clip = 0;
    while (at >= m_counts[clip]) at -= m_counts[clip++];
    return window(clip, std::clamp(at, 0, std::max(0, m_counts[clip] - frames)), frames);
}

void SkinningClips::statistics(SceneRandom& random, int samples, VectorX& mean,
                               VectorX& deviation) const {
    VectorX sum, squares;
    for (int k = 0; k < samples; ++k) {
        const VectorX features = random_window(random, 1).features.front();
        if (k == 0) {
            sum.setZero(features.size());
            squares.setZero(features.size());
        }
        sum += features;
        squares += features.cwiseAbs2();
    }
    mean = sum / samples;
    deviation = (squares / samples - mean.cwiseAbs2()).cwiseMax(1e-6).cwiseSqrt();
}

}  // namespace cloth
