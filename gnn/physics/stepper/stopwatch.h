#pragma once

#include <chrono>

namespace cloth {

/// Wall time by stages.
class Stopwatch {
 public:
    /// Time since the last lap, or since the watch was made (ms).
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double, std::milli> passed = now - m_last;
        m_last = now;
        return passed.count();
    }

 private:
    std::chrono::steady_clock::time_point m_last = std::chrono::steady_clock::now();
};

}  // namespace cloth
