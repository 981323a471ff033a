#include "demos/speed_error/pinning.h"

#include <omp.h>
#include <sched.h>

#include <filesystem>
#include <string>

#include "demos/compare/arguments.h"

namespace cloth {
namespace {

std::vector<int> allowed_cores() {
    cpu_set_t set;
    std::vector<int> cores;
    if (sched_getaffinity(0, sizeof(set), &set) != 0) return cores;
    for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &set)) cores.push_back(core);
    return cores;
}

void bind(int thread, const std::vector<int>& cores) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (int core : cores) CPU_SET(core, &set);
    sched_setaffinity(thread, sizeof(set), &set);
}

}  // namespace

std::vector<int> pin_threads(int threads) {
    std::vector<int> cores = allowed_cores();
    const int available = static_cast<int>(cores.size());
    if (threads > available)
        throw UsageError("--threads " + std::to_string(threads) + ": this process may use " +
                         std::to_string(available) + " cores");
    if (threads > 0) cores.resize(static_cast<size_t>(threads));
    // libraries may have started threads of their own
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
        bind(std::stoi(task.path().filename()), cores);
    omp_set_dynamic(0);
    omp_set_num_threads(static_cast<int>(cores.size()));
#pragma omp parallel
    bind(0, {cores[static_cast<size_t>(omp_get_thread_num())]});
    return cores;
}

}  // namespace cloth
