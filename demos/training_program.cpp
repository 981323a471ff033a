#include "demos/training_program.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/files/make_folder.h"

namespace cloth {

static std::atomic<bool> g_stop{false};

static void on_signal(int signal) {
    g_stop = true;
    std::signal(signal, SIG_DFL);
}

/// Linux may share the processor among sessions, and look at priorities within each alone
/// (sched(7), autogroup). A session of the training's own gives way as a whole.
static void lower_own_session(int nice) {
    if (getsid(0) == getpid()) std::ofstream("/proc/self/autogroup") << nice;
}

/// What would be overwritten is somebody's training, even without its checkpoint. A training that
/// was ended before its first checkpoint leaves metrics alone, and begins anew with --resume.
static void check_folder(const std::string& out, bool resume) {
    const auto has = [&](const char* file) { return std::filesystem::exists(out + "/" + file); };
    if (has("checkpoint.pt")) {
        if (resume) return;
        throw ArgumentError(out, "has a training already",
                            "give --resume to go on with it, or another --out");
    }
    for (const char* file : {"weights.safetensors", "metrics.csv", "rollouts.csv"})
        if (has(file) && (!resume || std::string(file) == "weights.safetensors"))
            throw ArgumentError(
                out,
                std::string("has ") + file + " of a training already, without its checkpoint.pt",
                "give another --out, or bring the checkpoint back for --resume");
}

void begin_training(const TrainingProgram& program) {
    if (program.writes) {
        make_folder(program.out);
        check_folder(program.out, program.resume);
    }
    check_range("--nice", program.nice, 0, 19);
    if (program.nice > 0 && setpriority(PRIO_PROCESS, 0, program.nice) != 0)
        std::cerr << program.name << ": the priority stays as it is: " << std::strerror(errno)
                  << "\n";
    if (program.nice > 0) lower_own_session(program.nice);
}

const std::atomic<bool>& stop_on_signals() {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    return g_stop;
}

}  // namespace cloth
