#include "demos/compare/comparison_scene.h"

#include <algorithm>
#include <cmath>

#include "data/mesh_io.h"
#include "data/paths.h"

namespace cloth {

Fabric fabric_named(const std::string& name) {
    return name == "real" ? Fabric::real_cotton() : Fabric::soft_cotton();
}

ComparisonScene::ComparisonScene(const CompareOptions& options) {
    const TriMesh rest = load_mesh(asset_path("garments/" + options.garment + ".obj"));
    m_garment = std::make_unique<Garment>(options.garment, rest, fabric_named(options.fabric));
    const auto body = std::make_shared<const Body>(Body::load_default());
    m_body = std::make_unique<AnimatedBody>(body, load_motion_by_name(options.motion));
    m_lead_in_frames = static_cast<int>(std::lround(m_body->settings().lead_in / frame_time));
    const int available = m_body->frame_count(frame_time) - 1 - m_lead_in_frames;
    if (available < 1)
        throw UsageError("--motion " + options.motion + ": is shorter than one frame");
    m_frames = options.frames == 0 ? available : std::min(options.frames, available);
    m_reference_frames =
        options.reference_frames == 0 ? m_frames : std::min(options.reference_frames, m_frames);
}

Boundary ComparisonScene::boundary(double t0, double t1) const {
    const double lead_in = m_lead_in_frames * frame_time;
    Boundary boundary;
    boundary.obstacles.push_back(m_body->obstacle(lead_in + t0, lead_in + t1));
    return boundary;
}

Points ComparisonScene::skin(double time) const {
    return m_body->vertices(m_lead_in_frames * frame_time + time);
}

}  // namespace cloth
