#include "demos/lookbook/look.h"

#include <algorithm>

#include "collision/proximity/metrics.h"
#include "demos/compare/figure_meshes.h"
#include "demos/compare/json_numbers.h"
#include "demos/compare/solver_factory.h"

namespace cloth {

Look::Look(const BodySceneSettings& settings, const std::string& solver, int threads)
    : m_scene(settings),
      m_garment(settings.garment),
      m_body(settings.body),
      m_motion(settings.motion),
      m_stepper(make_solver(solver, m_scene, {{}, threads, nullptr})),
      m_state(m_scene.start()) {
    for (int part = 0; part < m_scene.outfit().part_count(); ++part)
        m_faces.push_back(std::make_shared<const Faces>(m_scene.outfit().faces_of_part(part)));
}

void Look::settle() {
    for (int frame = -m_scene.lead_in_frames(); frame < 0; ++frame)
        m_stepper->step(m_scene.frame_boundary(frame), m_scene.frame_time(), m_state);
}

void Look::step() {
    const Boundary boundary = m_scene.frame_boundary(m_frame);
    measure(m_stepper->step(boundary, m_scene.frame_time(), m_state));
    const std::string loss = m_scene.loss(boundary, m_state.x);
    const bool is_last = m_frame + 1 == m_scene.frames();
    if (const auto since = m_loss.add(m_frame, !loss.empty(), is_last, m_scene.frame_time()))
        fail(*since, loss);
    ++m_frame;
}

void Look::measure(const StepReport& report) {
    const StretchStatistics stretch = measure_stretch(m_scene.garment(), m_state.x);
    m_stretch_p99 = std::max(m_stretch_p99, stretch.p99);
    m_stretch_max = std::max(m_stretch_max, stretch.max);
    m_depth = std::max(m_depth, report.max_penetration);
    if (!report.finite) ++m_failed_steps;
    if (stretch.p99 > 2.0) fail(m_frame, "torn: 1 % of the edges are stretched beyond 2");
}

/// Only the first failure counts.
void Look::fail(int frame, const std::string& how) {
    if (m_failure.empty()) m_failure = "frame " + std::to_string(frame) + ": " + how;
}

Scene Look::picture(size_t colour) const {
    Scene scene;
    const Points body = skin();
    scene.meshes.push_back(skin_mesh(body, m_scene.body().faces()));
    for (size_t part = 0; part < m_faces.size(); ++part)
        scene.meshes.push_back(garment_mesh(m_state.x, m_faces[part], colour + part));
    scene.ground.centre = body.colwise().mean().transpose();
    return scene;
}

nlohmann::ordered_json Look::measured() const {
    return {{"garment", m_garment},
            {"body", m_body},
            {"motion", m_motion},
            {"solver", m_stepper->name()},
            {"vertices", m_scene.garment().vertex_count()},
            {"frames", frame()},
            {"stretch_p99", rounded_number(m_stretch_p99)},
            {"stretch_max", rounded_number(m_stretch_max)},
            {"depth_mm", rounded_number(1e3 * m_depth)},
            {"failed_steps", m_failed_steps},
            {"failure",
             m_failure.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(m_failure)}};
}

}  // namespace cloth
