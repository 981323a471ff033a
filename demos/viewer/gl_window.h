#pragma once

#include <chrono>
#include <string>
#include <vector>

struct GLFWwindow;

namespace cloth {

/// A window of GLFW with an OpenGL 3.3 context, which becomes the current one, and with ImGui.
///
///     while (!window.is_closed()) {
///         window.take_events();
///         window.begin_picture();
///         ...                       // ImGui's widgets; what OpenGL draws
///         window.draw_panel();
///         window.show();
///     }
class GlWindow {
 public:
    /// @throws std::runtime_error with a remedy where there is no display or no OpenGL 3.3
    GlWindow(int width, int height);
    ~GlWindow();
    GlWindow(const GlWindow&) = delete;
    GlWindow& operator=(const GlWindow&) = delete;

    bool is_closed() const;
    void close();
    void set_title(const std::string& title);

    void take_events();
    void take_events_until(std::chrono::steady_clock::time_point time);
    /// Until there is one, or until that time.
    void wait_for_event(std::chrono::steady_clock::time_point time);
    /// Ends wait_for_event(); other threads may call it.
    void wake();
    /// Keys that were pressed since the last call, in that order, as GLFW numbers them.
    std::vector<int> take_keys();
    /// Whether mouse or keys did something since the last call.
    bool take_input();

    void begin_picture();
    void draw_panel();  ///< over what was drawn
    void show();

    int picture_width() const { return m_width; }    ///< (pixels)
    int picture_height() const { return m_height; }  ///< (pixels)

 private:
    void watch_input();
    void start_imgui();

    GLFWwindow* m_window = nullptr;
    std::vector<int> m_keys;
    bool m_has_input = false;
    int m_width = 1, m_height = 1;
};

}  // namespace cloth
