#include "demos/lookbook/look.h"

#include "collision/proximity/metrics.h"
#include "demos/compare/figure_meshes.h"
#include "demos/compare/json_numbers.h"
#include "demos/compare/solver_factory.h"
#include "demos/compare/statistics.h"

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
    const int now = frame();
    const Boundary boundary = m_scene.frame_boundary(now);
    const StepReport report = m_stepper->step(boundary, m_scene.frame_time(), m_state);
    measure(now, report);
    if (!m_failure.empty()) return;
    const std::string loss = m_scene.loss(boundary, m_state.x);
    if (!loss.empty()) m_failure = "frame " + std::to_string(now) + ": " + loss;
}

void Look::measure(int frame, const StepReport& report) {
    const StretchStatistics stretch = measure_stretch(m_scene.garment(), m_state.x);
    m_stretch_p99.push_back(stretch.p99);
    m_stretch_max.push_back(stretch.max);
    m_depth_mm.push_back(1e3 * report.max_penetration);
    if (!report.finite) ++m_failed_steps;
    if (stretch.p99 > 2.0 && m_failure.empty())
        m_failure =
            "frame " + std::to_string(frame) + ": torn: 1 % of the edges are stretched beyond 2";
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
    const auto most = [](const std::vector<double>& values) {
        return rounded_number(quantile(values, 1.0));
    };
    return {{"garment", m_garment},
            {"body", m_body},
            {"motion", m_motion},
            {"solver", m_stepper->name()},
            {"vertices", m_scene.garment().vertex_count()},
            {"frames", frame()},
            {"stretch_p99", most(m_stretch_p99)},
            {"stretch_max", most(m_stretch_max)},
            {"depth_mm", most(m_depth_mm)},
            {"failed_steps", m_failed_steps},
            {"failure",
             m_failure.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(m_failure)}};
}

}  // namespace cloth
