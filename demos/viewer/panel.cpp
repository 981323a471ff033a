#include "demos/viewer/panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "data/files/garment_assets.h"
#include "demos/compare/body_named.h"

namespace cloth {
namespace {

constexpr size_t times_shown = 150;
const ImVec4 warning(1.0f, 0.55f, 0.40f, 1.0f);

std::string text_of(const char* format, double value) {
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// @return  whether the mouse let go of it after a change
bool log_slider(const char* label, double& value, double low, double high, const char* format) {
    auto exponent = static_cast<float>(std::log10(value));
    const std::string shown = text_of(format, value);
    if (ImGui::SliderFloat(label, &exponent, static_cast<float>(std::log10(low)),
                           static_cast<float>(std::log10(high)), shown.c_str(),
                           ImGuiSliderFlags_NoInput))
        value = std::clamp(std::pow(10.0, static_cast<double>(exponent)), low, high);
    return ImGui::IsItemDeactivatedAfterEdit();
}

bool slider(const char* label, double& value, double low, double high, const char* format) {
    auto shown = static_cast<float>(value);
    const bool changed =
        ImGui::SliderFloat(label, &shown, static_cast<float>(low), static_cast<float>(high), format,
                           ImGuiSliderFlags_AlwaysClamp);
    if (changed) value = std::clamp(static_cast<double>(shown), low, high);
    return changed;
}

void row(const char* name, const std::string& value, bool alarming = false) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(125.0f);
    if (alarming)
        ImGui::TextColored(warning, "%s", value.c_str());
    else
        ImGui::TextUnformatted(value.c_str());
}

void warn(const std::string& text) {
    ImGui::PushTextWrapPos();
    ImGui::TextColored(warning, "%s", text.c_str());
    ImGui::PopTextWrapPos();
}

void legend(const ColourScale& scale) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x - 8.0f;
    constexpr float height = 12.0f;
    const auto pack = [](const Vec3& c) {
        return ImGui::ColorConvertFloat4ToU32(ImVec4(
            static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]), 1.0f));
    };
    const size_t last = scale.stops.size() - 1;
    const auto place = [&](size_t k) {
        return corner.x + width * static_cast<float>(k) / static_cast<float>(last);
    };
    for (size_t k = 0; k < last; ++k) {
        const ImU32 left = pack(scale.stops[k].colour), right = pack(scale.stops[k + 1].colour);
        list->AddRectFilledMultiColor(ImVec2(place(k), corner.y),
                                      ImVec2(place(k + 1), corner.y + height), left, right, right,
                                      left);
    }
    for (size_t k = 0; k <= last; ++k) {
        const char* label = scale.stops[k].label.c_str();
        const float text = ImGui::CalcTextSize(label).x;
        const float x = std::clamp(place(k) - 0.5f * text, corner.x, corner.x + width - text);
        list->AddText(ImVec2(x, corner.y + height), ImGui::GetColorU32(ImGuiCol_Text), label);
    }
    ImGui::Dummy(ImVec2(width, height + ImGui::GetTextLineHeightWithSpacing()));
}

/// @return  whether another one was chosen
bool choose(const char* label, const std::vector<std::string>& names, std::string& chosen) {
    bool changed = false;
    if (!ImGui::BeginCombo(label, chosen.c_str(), ImGuiComboFlags_HeightLarge)) return false;
    for (const std::string& name : names) {
        if (!ImGui::Selectable(name.c_str(), name == chosen) || name == chosen) continue;
        chosen = name;
        changed = true;
    }
    ImGui::EndCombo();
    return changed;
}

/// The names, and first the one that may be none of them.
std::vector<std::string> with(const std::string& name, std::vector<std::string> names) {
    if (std::find(names.begin(), names.end(), name) == names.end())
        names.insert(names.begin(), name);
    return names;
}

bool is_open(const char* title) {
    return ImGui::CollapsingHeader(title, ImGuiTreeNodeFlags_DefaultOpen);
}

}  // namespace

Panel::Panel(const SceneOptions& scene, const ViewerControls& start)
    : m_scene(scene),
      m_garments(with(scene.garment, with("tshirt_1000+pants_1000", garment_names()))),
      m_bodies(with(scene.shape, body_names())),
      m_motions(with(scene.motion, {"01_01", "01_03", "Boxing_Toes"})),
      m_kinds(solver_kinds()),
      m_choice(SolverChoice::of(start.solver)),
      m_fabric(start.fabric) {
}

void Panel::add_time(double ms) {
    m_times.push_back(static_cast<float>(ms));
    if (m_times.size() > times_shown) m_times.erase(m_times.begin());
}

void Panel::draw(ViewerControls& controls, const ViewerFrame& frame, int frames) {
    view.reset_camera = false;
    ImGui::SetNextWindowPos(ImVec2(0, 0));
    ImGui::SetNextWindowSize(ImVec2(width, ImGui::GetIO().DisplaySize.y));
    ImGui::SetNextWindowBgAlpha(0.92f);
    ImGui::Begin("viewer", nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PushItemWidth(165.0f);
    draw_playback(controls, frame, frames);
    if (m_scene.character.character.empty() && is_open("Who wears what")) draw_scene();
    if (is_open("Solver")) draw_solver(controls, frame);
    if (is_open("Fabric")) draw_fabric(controls);
    if (is_open("Wind and hand")) draw_world(controls);
    if (is_open("View")) draw_view(controls);
    if (is_open("Last step")) draw_report(frame);
    ImGui::PopItemWidth();
    ImGui::End();
}

void Panel::draw_playback(ViewerControls& controls, const ViewerFrame& frame, int frames) {
    if (ImGui::Button(controls.playing ? "Pause" : "Play", ImVec2(86, 0)))
        controls.playing = !controls.playing;
    ImGui::SameLine();
    if (ImGui::Button("Step", ImVec2(86, 0))) {
        controls.playing = false;
        ++controls.single_steps;
    }
    ImGui::SameLine();
    if (ImGui::Button("Restart", ImVec2(86, 0))) ++controls.restarts;
    ImGui::Checkbox("body moves", &controls.body_moves);
    ImGui::SameLine(125.0f);
    if (frame.frame < 0)
        ImGui::TextDisabled("into the first pose: %d", -frame.frame);
    else
        ImGui::TextDisabled("frame %d of %d", frame.frame, frames);
}

void Panel::draw_scene() {
    bool changed = choose("garment", m_garments, m_scene.garment);
    changed |= choose("body", m_bodies, m_scene.shape);
    changed |= choose("motion", m_motions, m_scene.motion);
    if (changed) wanted = m_scene;
    if (!scene_state.empty()) warn(scene_state);
}

void Panel::draw_solver(ViewerControls& controls, const ViewerFrame& frame) {
    bool changed = choose("solver", m_kinds, m_choice.kind);
    if (m_choice.has_number()) {
        ImGui::SliderInt(m_choice.kind == "xpbd-N" ? "N sub-steps" : "K iterations", &m_choice.k, 1,
                         100, "%d", ImGuiSliderFlags_AlwaysClamp);
        changed |= ImGui::IsItemDeactivatedAfterEdit();
    }
    if (changed) controls.solver = m_choice.name();
    if (!frame.refusal.empty()) warn(frame.refusal);
}

void Panel::draw_fabric(ViewerControls& controls) {
    bool changed = false;
    changed |= log_slider("density", m_fabric.density, 0.03, 1.0, "%.3f kg/m2");
    changed |= log_slider("mu", m_fabric.mu, 1.0, 1e4, "%.4g N/m");
    changed |= log_slider("lambda", m_fabric.lambda, 1.0, 1e4, "%.4g N/m");
    changed |= log_slider("bending", m_fabric.bending, 1e-8, 1e-2, "%.2e N m");
    if (ImGui::Button("soft cotton")) m_fabric = Fabric::soft_cotton(), changed = true;
    ImGui::SameLine();
    if (ImGui::Button("cotton as measured")) m_fabric = Fabric::real_cotton(), changed = true;
    if (changed) controls.fabric = m_fabric;
    if (m_fabric.mu < 7.5 || m_fabric.mu > 30.0)
        ImGui::TextDisabled("networks know mu of 7.5 to 30 N/m");
}

void Panel::draw_world(ViewerControls& controls) {
    slider("wind", controls.wind.speed, 0.0, 20.0, "%.1f m/s");
    slider("blows to", controls.wind.direction, -180.0, 180.0, "%.0f degrees");
    slider("gusts", controls.wind.gusts, 0.0, 1.0, "%.2f");
    log_slider("pull", controls.pull_settings.stiffness, 1.0, 200.0, "%.0f N/m");
    double mm = 1e3 * controls.pull_settings.radius;
    if (slider("patch", mm, 5.0, 200.0, "%.0f mm")) controls.pull_settings.radius = 1e-3 * mm;
}

void Panel::draw_view(ViewerControls& controls) {
    static const char* const modes[] = {"garments", "stretch", "contact"};
    auto mode = static_cast<int>(controls.colours);
    if (ImGui::Combo("colours", &mode, modes, 3)) controls.colours = static_cast<ColourMode>(mode);
    if (controls.colours == ColourMode::stretch) legend(stretch_scale());
    if (controls.colours == ColourMode::contact) legend(contact_scale());
    ImGui::Checkbox("wireframe", &view.wireframe);
    ImGui::SameLine(150.0f);
    ImGui::Checkbox("shadows", &view.shadows);
    ImGui::Checkbox("show body", &view.body);
    ImGui::SameLine(150.0f);
    ImGui::Checkbox("follow body", &view.follow);
    if (ImGui::Button("Reset camera")) view.reset_camera = true;
}

void Panel::draw_report(const ViewerFrame& frame) const {
    const StepReport& report = frame.report;
    if (!m_times.empty()) {
        const float highest = *std::max_element(m_times.begin(), m_times.end());
        const std::string caption = text_of("%.1f ms", frame.ms);
        ImGui::PlotLines("##times", m_times.data(), static_cast<int>(m_times.size()), 0,
                         caption.c_str(), 0.0f, 1.1f * highest,
                         ImVec2(ImGui::GetContentRegionAvail().x, 48.0f));
        row("graph", text_of("time per step, 0 to %.0f ms", 1.1 * static_cast<double>(highest)));
    }
    row("solver", frame.solver);
    row("iterations", std::to_string(report.iterations) + " in " + std::to_string(report.substeps) +
                          (report.substeps == 1 ? " part" : " parts"));
    row("stretch",
        text_of("%.2f, ", frame.stretch.p50) + text_of("99 %%: %.2f, ", frame.stretch.p99) +
            text_of("max %.2f", frame.stretch.max),
        frame.stretch.p99 > 2.0);
    row("depth", text_of("%.1f mm inside", 1e3 * report.max_penetration),
        report.max_penetration > 1e-3);
    row("in ignored limbs", std::to_string(report.vertices_in_ignored_limbs) + " vertices");
    row("tangles", frame.counts_tangles ? std::to_string(report.tangles) : "counted in layers only",
        report.tangles > 0);
    if (report.tunnelled) row("tunnelled", text_of("%.1f mm thick", 1e3 * *report.tunnelled), true);
    if (!frame.problem.empty()) warn(frame.problem);
}

}  // namespace cloth
