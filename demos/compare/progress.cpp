#include "demos/compare/progress.h"

#include <unistd.h>

namespace cloth {

static double seconds(std::chrono::steady_clock::duration duration) {
    return std::chrono::duration<double>(duration).count();
}

Progress::Progress(std::FILE* stream) : m_stream(stream), m_terminal(isatty(fileno(stream)) != 0) {
}

void Progress::update(int done, int all, const std::string& what) {
    const Clock::time_point now = Clock::now();
    if (what != m_what) {
        m_what = what;
        m_start = m_last_print = now;
    }
    const bool last = done >= all;
    if (!last && seconds(now - m_last_print) < (m_terminal ? 0.2 : 10.0)) return;
    m_last_print = now;
    const double spent = seconds(now - m_start);
    const double left = done > 0 ? spent / done * (all - done) : 0.0;
    std::fprintf(m_stream, "%s%s: %d of %d, %.0f s", m_terminal ? "\r\033[K" : "", what.c_str(),
                 done, all, spent);
    if (!last) std::fprintf(m_stream, ", %.0f s left", left);
    if (last || !m_terminal) std::fprintf(m_stream, "\n");
    std::fflush(m_stream);
}

}  // namespace cloth
