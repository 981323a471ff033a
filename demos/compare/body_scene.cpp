#include "demos/compare/body_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "collision/proximity/proximity.h"
#include "data/files/garment_assets.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_named.h"

namespace cloth {

namespace fs = std::filesystem;

Fabric fabric_named(const std::string& name) {
    if (name == "soft") return Fabric::soft_cotton();
    if (name == "real") return Fabric::real_cotton();
    throw UsageError("fabric " + name + ": choose soft or real");
}

void check_garment_name(const std::string& name) {
    const std::vector<std::string> names = garment_names();
    for (const std::string& part : outfit_parts(name))
        if (!fs::exists(part) && std::find(names.begin(), names.end(), part) == names.end())
            throw UsageError("garment " + part + ": choose one of " + join_list(names, ", ") +
                             ", several joined by +, or give a mesh file");
}

static Outfit outfit_of(const BodySceneSettings& settings, const Body& body) {
    check_garment_name(settings.garment);
    Outfit outfit = load_outfit(settings.garment, fabric_named(settings.fabric));
    if (settings.body == "default") return outfit;
    return fit_outfit(outfit, Body::load_default(), body);
}

BodyScene::BodyScene(const BodySceneSettings& settings)
    : BodyScene(settings, body_named(settings.body)) {
}

BodyScene::BodyScene(const BodySceneSettings& settings, std::shared_ptr<const Body> body)
    : BodyScene(settings, body, outfit_of(settings, *body)) {
}

BodyScene::BodyScene(const BodySceneSettings& settings, std::shared_ptr<const Body> body,
                     const Outfit& outfit)
    : ComparisonScene(outfit.garment, settings.rate),
      m_outfit(outfit),
      m_openings(outfit.garment, outfit.start.x, *body) {
    if (outfit.has_layers()) m_self_contact.thickness = Outfit::thickness;
    AnimationSettings animation;
    animation.limbs = settings.limbs;
    m_body = std::make_unique<AnimatedBody>(body, load_motion_by_name(settings.motion), animation);
    m_lead_in_frames = static_cast<int>(std::lround(m_body->settings().lead_in / frame_time()));
    const int available = m_body->frame_count(frame_time()) - 1 - m_lead_in_frames;
    if (available < 1)
        throw UsageError("motion " + settings.motion + ": is shorter than one frame");
    const int frames = settings.frames == 0 ? available : std::min(settings.frames, available);
    const int references = settings.reference_frames == 0 ? frames : settings.reference_frames;
    set_length(frames, std::min(references, frames));
    find_covered_skin();
}

Boundary BodyScene::boundary(double t0, double t1) const {
    const double lead_in = m_lead_in_frames * frame_time();
    Boundary boundary;
    boundary.obstacles.push_back(m_body->obstacle(lead_in + t0, lead_in + t1));
    return boundary;
}

Points BodyScene::skin(double time) const {
    return m_body->vertices(m_lead_in_frames * frame_time() + time);
}

std::vector<BodySegment> BodyScene::segments() const {
    const Body& body = m_body->body();
    return segment_body(body.rest_mesh(), body.dominant_joint());
}

void BodyScene::find_covered_skin() {
    Proximity proximity;
    SurfaceContacts contacts;
    Boundary boundary;
    boundary.obstacles.push_back(m_body->obstacle(0.0, 0.0));
    proximity.query(m_outfit.start.x, boundary, contacts);
    const Faces& faces = *m_body->faces();
    for (Eigen::Index i = 0; i < m_outfit.start.x.rows(); ++i)
        if (contacts.has(i)) m_covered.push_back(faces(contacts.face[static_cast<size_t>(i)], 0));
    m_start_offset =
        m_outfit.start.x.colwise().mean().transpose() - middle_of_covered(boundary.obstacles[0].x0);
}

Vec3 BodyScene::middle_of_covered(const Points& skin) const {
    Vec3 sum = Vec3::Zero();
    for (const int vertex : m_covered) sum += skin.row(vertex).transpose();
    return sum / std::max(1.0, static_cast<double>(m_covered.size()));
}

bool BodyScene::is_near_covered(const Points& skin, const Points& x) const {
    const Vec3 offset = x.colwise().mean().transpose() - middle_of_covered(skin);
    return (offset - m_start_offset).norm() <= 0.3;
}

std::string BodyScene::loss(const Boundary& boundary, const Points& x) const {
    const Points& skin = boundary.obstacles[0].x1;
    if (!is_near_covered(skin, x)) return "slid off the body";
    const std::string limb = m_openings.slipped_limb(skin, x);
    return limb.empty() ? "" : limb + " slipped out of an opening";
}

}  // namespace cloth
