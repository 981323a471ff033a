#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace cloth {

/// A line that tells how far a long computation is and how long it will take: rewritten in place on
/// a terminal, a plain line every few seconds otherwise.
class Progress {
 public:
    explicit Progress(std::FILE* stream = stdout);

    void update(int done, int all, const std::string& what);

 private:
    using Clock = std::chrono::steady_clock;
    std::FILE* m_stream;
    bool m_terminal;
    std::string m_what;
    Clock::time_point m_start, m_last_print;
};

}  // namespace cloth
