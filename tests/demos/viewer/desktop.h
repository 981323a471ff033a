#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "render/image.h"
#include "tests/render/temporary_folder.h"

namespace cloth::test {

/// A program that was started; it is ended with the object.
class ChildProgram {
 public:
    /// @param output  file that its output and errors go to; empty: none
    ChildProgram(const std::vector<std::string>& command, const std::string& output,
                 const std::vector<std::string>& environment = {});
    ~ChildProgram();
    ChildProgram(const ChildProgram&) = delete;
    ChildProgram& operator=(const ChildProgram&) = delete;

    bool is_running();
    int wait();  ///< its exit status; negative: a signal ended it

 private:
    pid_t m_id;
    bool m_ended = false;
    int m_status = 0;
};

/// Xvfb: a screen that is a file, with a mouse and keys that xdotool moves. There is no window
/// manager: a window appears at the top left corner, and keys go to where the mouse is.
class Desktop {
 public:
    static bool is_installed();  ///< Xvfb and xdotool

    /// @param options  more of Xvfb's
    Desktop(int width, int height, const std::vector<std::string>& options = {});

    /// As DISPLAY has it, such as ":7".
    const std::string& display() const { return m_display; }
    Image screen() const;
    /// Runs xdotool with these arguments, and returns what it prints.
    std::string xdotool(const std::string& arguments) const;
    void move(int x, int y) const;
    void press(int button = 1) const { xdotool("mousedown " + std::to_string(button)); }
    void release(int button = 1) const { xdotool("mouseup " + std::to_string(button)); }
    void click(int x, int y) const;
    void key(const std::string& name) const { xdotool("key " + name); }
    /// Moves with the left button pressed, as a hand does: in small steps.
    void drag(int x0, int y0, int x1, int y1) const;

 private:
    TemporaryFolder m_folder;
    std::string m_display;
    ChildProgram m_server;
};

/// Whether it becomes true within so many seconds.
bool becomes_true(const std::function<bool()>& condition, double seconds = 120.0);

void wait_seconds(double seconds);

}  // namespace cloth::test
