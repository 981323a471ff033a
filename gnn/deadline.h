#pragma once

#include <chrono>
#include <limits>

namespace cloth {

/// A time at which work has to be done. By default there is none.
class Deadline {
 public:
    Deadline() = default;

    /// So many milliseconds from now; what is not above 0 has passed.
    static Deadline in(double ms) {
        Deadline deadline;
        deadline.m_end = Clock::now() + to_ticks(ms);
        deadline.m_set = true;
        return deadline;
    }

    bool is_set() const { return m_set; }

    /// What is left (ms), negative afterwards; infinite without a deadline.
    double left() const {
        if (!m_set) return std::numeric_limits<double>::infinity();
        return std::chrono::duration<double, std::milli>(m_end - Clock::now()).count();
    }

    /// The same, earlier by so many milliseconds.
    Deadline earlier(double ms) const {
        Deadline deadline = *this;
        if (m_set) deadline.m_end -= to_ticks(ms);
        return deadline;
    }

 private:
    using Clock = std::chrono::steady_clock;
    static Clock::duration to_ticks(double ms) {
        return std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double, std::milli>(ms));
    }

    Clock::time_point m_end;
    bool m_set = false;
};

}  // namespace cloth
