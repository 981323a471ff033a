#include "demos/viewer/gl_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace cloth {
namespace {

std::string& glfw_problem() {
    static std::string problem;
    return problem;
}

std::runtime_error window_error(const std::string& remedy) {
    const std::string& problem = glfw_problem();
    return std::runtime_error("viewer: no window can be opened" +
                              (problem.empty() ? "" : " (" + problem + ")") +
                              ". Remedy: " + remedy);
}

}  // namespace

GlWindow::GlWindow(int width, int height) {
    glfwSetErrorCallback([](int, const char* text) { glfw_problem() = text; });
    if (!glfwInit())
        throw window_error(
            "run it on a desktop, or over `ssh -X`; without a screen, for --frames and "
            "--screenshot: apt-get install xvfb xauth, and put `xvfb-run -a -s \"-screen 0 "
            "1280x800x24\"` before the command");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    m_window = glfwCreateWindow(width, height, "viewer", nullptr, nullptr);
    if (!m_window) {
        glfwTerminate();
        throw window_error(
            "install a driver for OpenGL 3.3, such as Debian's libgl1-mesa-dri, or set "
            "LIBGL_ALWAYS_SOFTWARE=1");
    }
    glfwMakeContextCurrent(m_window);
    glfwSwapInterval(0);  // the caller waits by itself
    watch_input();
    start_imgui();
}

/// ImGui, which calls these too, knows of what is there when a picture begins: it would miss keys
/// that are pressed and released before.
void GlWindow::watch_input() {
    glfwSetWindowUserPointer(m_window, this);
    static const auto self = [](GLFWwindow* window) -> GlWindow& {
        return *static_cast<GlWindow*>(glfwGetWindowUserPointer(window));
    };
    glfwSetKeyCallback(m_window, [](GLFWwindow* window, int key, int, int action, int) {
        self(window).m_has_input = true;
        if (action == GLFW_PRESS || (action == GLFW_REPEAT && key == GLFW_KEY_N))
            self(window).m_keys.push_back(key);
    });
    glfwSetCursorPosCallback(
        m_window, [](GLFWwindow* window, double, double) { self(window).m_has_input = true; });
    glfwSetMouseButtonCallback(
        m_window, [](GLFWwindow* window, int, int, int) { self(window).m_has_input = true; });
    glfwSetScrollCallback(
        m_window, [](GLFWwindow* window, double, double) { self(window).m_has_input = true; });
}

GlWindow::~GlWindow() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(m_window);
    glfwTerminate();
}

void GlWindow::start_imgui() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0.0f;
    style.FrameRounding = 3.0f;
    style.FramePadding.y = 2.0f;  // so that the panel fits into 800 pixels
    style.ItemSpacing.y = 3.0f;
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // it would write into the working folder
    const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    if (std::filesystem::exists(font)) io.Fonts->AddFontFromFileTTF(font, 14.0f);
    ImGui_ImplGlfw_InitForOpenGL(m_window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

bool GlWindow::is_closed() const {
    return glfwWindowShouldClose(m_window) != 0;
}

void GlWindow::close() {
    glfwSetWindowShouldClose(m_window, GLFW_TRUE);
}

void GlWindow::set_title(const std::string& title) {
    glfwSetWindowTitle(m_window, title.c_str());
}

void GlWindow::take_events() {
    glfwPollEvents();
}

void GlWindow::take_events_until(std::chrono::steady_clock::time_point time) {
    for (;;) {
        const auto left = time - std::chrono::steady_clock::now();
        if (left <= left.zero()) return;
        glfwWaitEventsTimeout(std::chrono::duration<double>(left).count());
    }
}

void GlWindow::wait_for_event(std::chrono::steady_clock::time_point time) {
    const auto left = time - std::chrono::steady_clock::now();
    if (left > left.zero()) glfwWaitEventsTimeout(std::chrono::duration<double>(left).count());
}

void GlWindow::wake() {
    glfwPostEmptyEvent();
}

std::vector<int> GlWindow::take_keys() {
    return std::exchange(m_keys, {});
}

bool GlWindow::take_input() {
    return std::exchange(m_has_input, false);
}

void GlWindow::begin_picture() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    glfwGetFramebufferSize(m_window, &m_width, &m_height);
    m_width = std::max(m_width, 1);  // 0 where it is an icon
    m_height = std::max(m_height, 1);
}

void GlWindow::draw_panel() {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void GlWindow::show() {
    glfwSwapBuffers(m_window);
}

}  // namespace cloth
