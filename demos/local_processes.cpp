#include "demos/local_processes.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "data/core/errors.h"

namespace cloth {

namespace {

[[noreturn]] void become(int rank, int count, char** arguments, int port, const sigset_t& mask) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    setpgid(0, 0);  // Ctrl-C would reach it twice else
    setenv("RANK", std::to_string(rank).c_str(), 1);
    setenv("WORLD_SIZE", std::to_string(count).c_str(), 1);
    setenv("MASTER_ADDR", "127.0.0.1", 1);
    setenv("MASTER_PORT", std::to_string(port).c_str(), 1);
    sigprocmask(SIG_SETMASK, &mask, nullptr);
    execv("/proc/self/exe", arguments);
    _exit(127);
}

void tell(const std::vector<pid_t>& children, int signal) {
    for (const pid_t child : children) kill(child, signal);
}

}  // namespace

int run_local_processes(int count, char** arguments, int port) {
    sigset_t signals, before;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&signals, signal);
    sigprocmask(SIG_BLOCK, &signals, &before);
    std::vector<pid_t> children;
    for (int rank = 0; rank < count; ++rank) {
        const pid_t child = fork();
        if (child == 0) become(rank, count, arguments, port, before);
        if (child < 0) {
            tell(children, SIGKILL);
            throw ArgumentError(std::to_string(count) + " processes",
                                std::string("cannot be started: ") + std::strerror(errno),
                                "use fewer");
        }
        children.push_back(child);
    }
    int failure = 0;
    while (!children.empty()) {
        int signal = 0;
        sigwait(&signals, &signal);
        if (signal != SIGCHLD) tell(children, signal);
        int status = 0;
        for (pid_t ended; (ended = waitpid(-1, &status, WNOHANG)) > 0;) {
            children.erase(std::remove(children.begin(), children.end(), ended), children.end());
            const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            if (code == 0 || failure != 0) continue;
            failure = code;
            tell(children, SIGTERM);
        }
    }
    sigprocmask(SIG_SETMASK, &before, nullptr);
    return failure;
}

}  // namespace cloth
