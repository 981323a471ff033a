#include "tests/demos/viewer/desktop.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <thread>

namespace cloth::test {
namespace {

std::string output_of(const std::string& command) {
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) throw std::runtime_error("cannot be run: " + command);
    std::string text;
    char part[256];
    while (fgets(part, sizeof part, pipe)) text += part;
    pclose(pipe);
    return text;
}

std::vector<std::string> server_command(int width, int height, const std::string& folder,
                                        const std::vector<std::string>& options) {
    std::vector<std::string> command = {
        "Xvfb",    "-displayfd", "1",
        "-screen", "0",          std::to_string(width) + "x" + std::to_string(height) + "x24",
        "-fbdir",  folder,       "-nolisten",
        "tcp"};
    command.insert(command.end(), options.begin(), options.end());
    return command;
}

/// A field of the header of an XWD file, which is what Xvfb writes.
size_t xwd_field(const std::string& bytes, size_t index) {
    const auto at = [&](size_t k) {
        return static_cast<size_t>(static_cast<unsigned char>(bytes[4 * index + k]));
    };
    return at(0) << 24 | at(1) << 16 | at(2) << 8 | at(3);
}

}  // namespace

ChildProgram::ChildProgram(const std::vector<std::string>& command, const std::string& output,
                           const std::vector<std::string>& environment)
    : m_id(fork()) {
    if (m_id < 0) throw std::runtime_error("no process can be made");
    if (m_id > 0) return;
    const int file =
        open(output.empty() ? "/dev/null" : output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(file, 1);
    dup2(file, 2);
    for (const std::string& variable : environment) putenv(strdup(variable.c_str()));
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(strdup(argument.c_str()));
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
}

ChildProgram::~ChildProgram() {
    if (!is_running()) return;
    kill(m_id, SIGKILL);
    wait();
}

bool ChildProgram::is_running() {
    if (!m_ended) m_ended = waitpid(m_id, &m_status, WNOHANG) == m_id;
    return !m_ended;
}

int ChildProgram::wait() {
    if (!m_ended) waitpid(m_id, &m_status, 0);
    m_ended = true;
    return WIFEXITED(m_status) ? WEXITSTATUS(m_status) : -WTERMSIG(m_status);
}

bool Desktop::is_installed() {
    return !output_of("command -v Xvfb").empty() && !output_of("command -v xdotool").empty();
}

Desktop::Desktop(int width, int height, const std::vector<std::string>& options)
    : m_server(server_command(width, height, m_folder.file("."), options),
               m_folder.file("server.txt")) {
    const auto number = [&] {
        const std::string text = content_of(m_folder.file("server.txt"));
        // it complains of keys that it does not know in other lines
        const size_t end = text.find_last_not_of('\n'), begin = text.find_last_of('\n', end);
        return text.empty() || text.back() != '\n'
                   ? std::string()
                   : text.substr(begin == std::string::npos ? 0 : begin + 1,
                                 end - (begin == std::string::npos ? -1 : begin));
    };
    const auto is_number = [](const std::string& text) {
        return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    };
    if (!becomes_true([&] { return is_number(number()); }))
        throw std::runtime_error("Xvfb does not start: " + content_of(m_folder.file("server.txt")));
    m_display = ":" + number();
}

Image Desktop::screen() const {
    const std::string bytes = content_of(m_folder.file("Xvfb_screen0"));
    const auto width = static_cast<int>(xwd_field(bytes, 4));
    const auto height = static_cast<int>(xwd_field(bytes, 5));
    const size_t line = xwd_field(bytes, 12);
    const size_t begin = xwd_field(bytes, 0) + 12 * xwd_field(bytes, 19);  // after the colour map
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const size_t at = begin + static_cast<size_t>(y) * line + 4 * static_cast<size_t>(x);
            const auto byte = [&](size_t k) { return static_cast<std::uint8_t>(bytes[at + k]); };
            image.at(x, y) = {byte(2), byte(1), byte(0)};
        }
    return image;
}

std::string Desktop::xdotool(const std::string& arguments) const {
    return output_of("DISPLAY=" + m_display + " xdotool " + arguments);
}

void Desktop::move(int x, int y) const {
    xdotool("mousemove " + std::to_string(x) + " " + std::to_string(y));
}

void Desktop::click(int x, int y) const {
    move(x, y);
    wait_seconds(0.3);
    press();
    wait_seconds(0.3);
    release();
    wait_seconds(0.3);
}

void Desktop::drag(int x0, int y0, int x1, int y1) const {
    move(x0, y0);
    wait_seconds(0.3);
    press();
    wait_seconds(0.3);
    for (int k = 1; k <= 8; ++k) {
        move(x0 + (x1 - x0) * k / 8, y0 + (y1 - y0) * k / 8);
        wait_seconds(0.05);
    }
}

bool becomes_true(const std::function<bool()>& condition, double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        wait_seconds(0.1);
    }
    return true;
}

void wait_seconds(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace cloth::test
