#include "demos/viewer/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <utility>
#include <vector>

#include "demos/compare/figure_meshes.h"
#include "demos/viewer/drawer.h"
#include "demos/viewer/gl_window.h"
#include "demos/viewer/orbit_camera.h"
#include "demos/viewer/panel.h"
#include "demos/viewer/pick.h"
#include "demos/viewer/step_thread.h"
#include "demos/viewer/viewer_scene.h"

namespace cloth {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double picture_time = 1.0 / 60.0;  // (s)

/// The loop: it shows what the scene has done last, while a thread makes the next step.
class Viewer {
 public:
    Viewer(const ViewerOptions& options, GlWindow& window)
        : m_options(options),
          m_window(window),
          m_scene(std::make_unique<ViewerScene>(options.scene, options.threads)),
          m_controls(first_controls(options, *m_scene)),
          m_panel(options.scene, m_controls) {
        m_panel.view.wireframe = options.wireframe;
        show_scene();
    }

    void run() {
        auto next_picture = Clock::now();
        while (!m_window.is_closed()) {
            take_step();
            start_step();
            m_window.take_events();
            draw();
            if (m_options.frames > 0 && m_shown.steps >= m_options.frames) break;
            if (m_options.frames > 0) continue;
            next_picture = std::max(next_picture + ticks(picture_time), Clock::now());
            m_window.take_events_until(next_picture);
            rest();
        }
        m_thread.wait();
        save_picture();
    }

 private:
    /// Where the user does nothing, pictures are drawn for new steps, and seldom without: software
    /// that draws has the same cores as the solver.
    void rest() {
        const auto now = Clock::now();
        if (m_window.take_input() || m_controls.pull) m_awake_until = now + ticks(0.3);
        if (now < m_awake_until || (m_new && m_thread.is_idle())) return;
        auto end = now + ticks(0.2);
        if (m_controls.playing && m_thread.is_idle()) end = std::min(end, m_next_step);
        m_window.wait_for_event(end);
    }

    static Clock::duration ticks(double seconds) {
        return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }

    static ViewerControls first_controls(const ViewerOptions& options, const ViewerScene& scene) {
        ViewerControls controls = scene.controls();
        controls.playing = !options.paused;
        controls.wind.speed = options.wind;
        if (options.colours == "stretch") controls.colours = ColourMode::stretch;
        if (options.colours == "contact") controls.colours = ColourMode::contact;
        return controls;
    }

    /// What is shown of a new scene.
    void show_scene() {
        m_shown = m_scene->frame();
        for (const std::string& note : m_scene->notes()) std::printf("%s\n", note.c_str());
        m_body_faces = std::make_shared<const Faces>(m_scene->body_faces());
        m_part_faces.clear();
        for (const Faces& part : m_scene->parts())
            m_part_faces.push_back(std::make_shared<const Faces>(part));
        m_ground_height = m_shown.skin.col(1).minCoeff();
        m_panel.clear_times();
        m_load = true;
        show_title();
    }

    /// The user goes on looking at the old scene until the new one is there.
    void make_scene(SceneOptions options) {
        options.solver = m_controls.solver;
        m_panel.scene_state = "is being made ...";
        m_new = m_makes_scene = true;
        m_thread.start([this, options] {
            try {
                m_next_scene = std::make_unique<ViewerScene>(options, m_options.threads);
                m_options.scene = options;
                m_refusal.clear();
            } catch (const std::exception& error) {
                m_refusal = error.what();
            }
            m_window.wake();
        });
    }

    void take_scene() {
        m_panel.scene_state = m_refusal;
        if (!m_next_scene) return;
        m_scene = std::move(m_next_scene);
        m_controls.restarts = m_controls.single_steps = 0;
        m_controls.pull.reset();
        show_scene();
    }

    void take_step() {
        if (m_options.frames > 0) m_thread.wait();
        if (!m_thread.is_idle() || !m_new) return;
        m_new = false;
        if (m_makes_scene) {
            m_makes_scene = false;
            return take_scene();
        }
        const ViewerFrame& frame = m_scene->frame();
        if (frame.steps > m_shown.steps) m_panel.add_time(frame.ms);
        if (m_panel.view.follow) {
            Vec3 way = (frame.skin.colwise().mean() - m_shown.skin.colwise().mean()).transpose();
            way.y() = 0.0;
            m_camera.move(way);
        }
        const bool other_solver = frame.solver != m_shown.solver;
        m_shown = frame;
        m_load = true;
        if (other_solver) show_title();
    }

    void show_title() {
        m_window.set_title("viewer: " + m_options.scene.garment + ", " + m_shown.solver);
    }

    /// Steps keep to the clock, or come one after the other where they take longer.
    void start_step() {
        if (m_new || !m_thread.is_idle()) return;
        if (m_panel.wanted) {
            make_scene(*std::exchange(m_panel.wanted, std::nullopt));
            return;
        }
        const auto now = Clock::now();
        const bool due = m_controls.playing && (now >= m_next_step || m_options.frames > 0);
        if (!due && m_controls == m_handed) return;
        ViewerControls controls = m_controls;
        controls.playing = due;
        if (due) m_next_step = std::max(m_next_step + ticks(m_scene->frame_time()), now);
        m_handed = m_controls;
        m_new = true;
        m_thread.start([this, controls] {
            m_scene->advance(controls);
            m_window.wake();
        });
    }

    void draw() {
        m_window.begin_picture();
        m_panel.draw(m_controls, m_shown, m_scene->frames());
        const double shift = 0.5 * static_cast<double>(Panel::width) / io().DisplaySize.x;
        const double aspect =
            static_cast<double>(m_window.picture_width()) / m_window.picture_height();
        if (m_first || m_panel.view.reset_camera)
            m_camera.frame(m_shown.skin, aspect * (1.0 - 2.0 * shift));
        m_first = false;
        use_keys();
        m_view = m_camera.camera(shift, aspect);
        use_mouse();
        m_view = m_camera.camera(shift, aspect);
        draw_hand();
        if (m_load || m_panel.view.shadows != m_shadows || m_panel.view.body != m_body) load();
        m_drawer.draw(m_view, m_window.picture_width(), m_window.picture_height(),
                      m_panel.view.wireframe);
        m_window.draw_panel();
        if (is_last_picture())
            m_picture = drawn_picture(m_window.picture_width(), m_window.picture_height());
        m_window.show();
    }

    bool is_last_picture() const {
        if (m_options.screenshot.empty()) return false;
        return m_window.is_closed() || (m_options.frames > 0 && m_shown.steps >= m_options.frames);
    }

    void load() {
        m_load = false;
        m_shadows = m_panel.view.shadows;
        m_body = m_panel.view.body;
        Scene scene;
        std::vector<Points> colours;
        for (size_t part = 0; part < m_part_faces.size(); ++part) {
            scene.meshes.push_back(garment_mesh(m_shown.cloth, m_part_faces[part], part + 1));
            colours.push_back(m_shown.colours);
        }
        if (m_body) scene.meshes.push_back(skin_mesh(m_shown.skin, m_body_faces));
        // Flat faces of cloth cut round skin. Where contact is looked at, that is shown.
        if (m_body && m_controls.colours != ColourMode::contact)
            scene.meshes.back().depth_offset = 2e-3;
        scene.ground.centre = m_shown.skin.colwise().mean().transpose();
        scene.ground.height = m_ground_height;
        scene.lights.shadows = m_shadows;
        m_drawer.load(scene, colours);
    }

    static ImGuiIO& io() { return ImGui::GetIO(); }

    void use_keys() {
        for (const int key : m_window.take_keys())
            if (!io().WantTextInput) use_key(key);
    }

    void use_key(int key) {
        switch (key) {
            case GLFW_KEY_SPACE:
                m_controls.playing = !m_controls.playing;
                break;
            case GLFW_KEY_N:
                m_controls.playing = false;
                ++m_controls.single_steps;
                break;
            case GLFW_KEY_R:
                ++m_controls.restarts;
                break;
            case GLFW_KEY_W:
                m_panel.view.wireframe = !m_panel.view.wireframe;
                break;
            case GLFW_KEY_C:
                m_controls.colours =
                    static_cast<ColourMode>((static_cast<int>(m_controls.colours) + 1) % 3);
                break;
            case GLFW_KEY_ESCAPE:
                m_window.close();
                break;
            default:
                break;
        }
    }

    /// The left button drags cloth where it is pressed on cloth, and turns the camera elsewhere.
    void use_mouse() {
        const Ray ray = ray_through(
            m_view, static_cast<double>(io().MousePos.x), static_cast<double>(io().MousePos.y),
            static_cast<int>(io().DisplaySize.x), static_cast<int>(io().DisplaySize.y));
        if (!io().WantCaptureMouse) {
            if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) grip(ray);
            m_camera.zoom(static_cast<double>(io().MouseWheel));
            move_camera();
        }
        if (!m_controls.pull) return;
        if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
            m_controls.pull.reset();
            return;
        }
        m_controls.pull->target = on_picture_plane(ray, m_view, m_grip);
    }

    void grip(const Ray& ray) {
        const Faces none(0, 3);
        const auto vertex = shown_vertex(ray, m_shown.cloth, m_scene->garment_faces(), m_shown.skin,
                                         m_panel.view.body ? *m_body_faces : none);
        if (!vertex) return;
        m_grip = m_shown.cloth.row(*vertex).transpose();
        m_controls.pull = ViewerControls::Pull{*vertex, m_grip};
    }

    void move_camera() {
        const double right = static_cast<double>(io().MouseDelta.x / io().DisplaySize.y);
        const double down = static_cast<double>(io().MouseDelta.y / io().DisplaySize.y);
        const bool left = ImGui::IsMouseDown(ImGuiMouseButton_Left) && !m_controls.pull;
        if (ImGui::IsMouseDown(ImGuiMouseButton_Middle) || (left && io().KeyShift))
            m_camera.pan(right, down);
        else if (left || ImGui::IsMouseDown(ImGuiMouseButton_Right))
            m_camera.orbit(right, down);
    }

    void draw_hand() {
        if (!m_controls.pull) return;
        const auto place = [&](const Vec3& point) {
            const PixelPosition pixel = project(m_view, point, static_cast<int>(io().DisplaySize.x),
                                                static_cast<int>(io().DisplaySize.y));
            return ImVec2(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
        };
        ImDrawList* list = ImGui::GetBackgroundDrawList();
        const ImVec2 from = place(m_shown.cloth.row(m_controls.pull->vertex).transpose());
        const ImVec2 to = place(m_controls.pull->target);
        list->AddLine(from, to, IM_COL32(30, 30, 34, 220), 2.0f);
        list->AddCircleFilled(from, 4.0f, IM_COL32(255, 214, 120, 255));
        list->AddCircle(to, 6.0f, IM_COL32(255, 214, 120, 255), 0, 2.0f);
    }

    void save_picture() const {
        if (m_options.screenshot.empty() || m_picture.empty()) return;
        write_png(m_options.screenshot, m_picture);
    }

    ViewerOptions m_options;
    GlWindow& m_window;
    std::unique_ptr<ViewerScene> m_scene;  ///< the thread's, while that is not idle
    std::unique_ptr<ViewerScene> m_next_scene;
    std::string m_refusal;  ///< why there is no next scene
    ViewerControls m_controls, m_handed;
    Panel m_panel;
    ViewerFrame m_shown;
    std::shared_ptr<const Faces> m_body_faces;
    std::vector<std::shared_ptr<const Faces>> m_part_faces;
    double m_ground_height = 0.0;
    Drawer m_drawer;
    OrbitCamera m_camera;
    Camera m_view;
    Vec3 m_grip = Vec3::Zero();  ///< where the cloth was gripped (m)
    bool m_first = true, m_load = true, m_shadows = true, m_body = true;
    bool m_makes_scene = false;  ///< that is the thread's job
    bool m_new = false;          ///< the thread has something that is not shown yet
    Clock::time_point m_next_step = Clock::now(), m_awake_until = Clock::now();
    Image m_picture;
    StepThread m_thread;  ///< last: it ends before what it uses
};

}  // namespace

void run_viewer(const ViewerOptions& options) {
    GlWindow window(options.width, options.height);
    Viewer viewer(options, window);
    viewer.run();
}

}  // namespace cloth
