#include "demos/compare/memory.h"

#include <fstream>
#include <limits>
#include <string>

namespace cloth {

static double status_mb(const std::string& field) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind(field + ":", 0) == 0)
            return std::stod(line.substr(field.size() + 1)) * 1024.0 / 1e6;
    return std::numeric_limits<double>::quiet_NaN();
}

double resident_memory_mb() {
    return status_mb("VmRSS");
}

double peak_memory_mb() {
    return status_mb("VmHWM");
}

void reset_peak_memory() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace cloth
