#include "demos/provenance/provenance.h"

#include <ctime>
#include <fstream>
#include <thread>

namespace cloth {

namespace {

std::string today() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[16];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%d", &utc)};
}

}  // namespace

std::string machine_name() {
    std::ifstream info("/proc/cpuinfo");
    std::string name = "unknown processor";
    for (std::string line; std::getline(info, line);)
        if (line.rfind("model name", 0) == 0) {
            name = line.substr(line.find(':') + 2);
            break;
        }
    return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

nlohmann::ordered_json provenance_json(int threads) {
    return {{"commit", build_commit()},
            {"machine", machine_name()},
            {"threads", threads},
            {"date", today()}};
}

}  // namespace cloth
