#include "demos/train_series/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "data/core/errors.h"

namespace cloth {

namespace {

volatile std::sig_atomic_t g_child = 0, g_interrupted = 0;

void hand_on(int signal) {
    if (g_interrupted == 0 && g_child > 0) kill(static_cast<pid_t>(g_child), signal);
    g_interrupted = 1;
}

/// Handles the signals for as long as it lives.
class SignalsHandedOn {
 public:
    SignalsHandedOn() {
        g_interrupted = 0;
        struct sigaction action = {};
        action.sa_handler = hand_on;
        for (size_t k = 0; k < signals.size(); ++k) sigaction(signals[k], &action, &m_before[k]);
    }
    ~SignalsHandedOn() {
        for (size_t k = 0; k < signals.size(); ++k) sigaction(signals[k], &m_before[k], nullptr);
        g_child = 0;
    }
    SignalsHandedOn(const SignalsHandedOn&) = delete;
    SignalsHandedOn& operator=(const SignalsHandedOn&) = delete;

 private:
    static constexpr std::array<int, 2> signals = {SIGINT, SIGTERM};
    std::array<struct sigaction, 2> m_before = {};
};

/// In a process group of its own: Ctrl-C would reach it twice else.
pid_t spawn(const std::vector<std::string>& command, const std::string& log) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0644);
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::vector<char*> arguments;
    for (const std::string& argument : command)
        arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int error =
        posix_spawn(&child, arguments[0], &files, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0)
        throw LoadError(command.front(), "", std::string("cannot be run: ") + std::strerror(error),
                        "build it: cmake --build --preset release --target train");
    return child;
}

double seconds(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ChildResult run_child(const std::vector<std::string>& command, const std::string& log) {
    const SignalsHandedOn signals;
    const pid_t child = spawn(command, log);
    g_child = static_cast<std::sig_atomic_t>(child);
    int status = 0;
    rusage usage = {};
    while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    ChildResult result;
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.processor_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    result.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
    result.interrupted = g_interrupted != 0;
    return result;
}

}  // namespace cloth
