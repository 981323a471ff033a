#pragma once

namespace cloth {

/// When to interrupt long work for something dear that happens again and again, such as validation:
/// not more often than every so many seconds, and for no more than a share of the whole time. What
/// the next time will cost is taken from the last.
///
///     TimeBudget budget(0.1, 600.0, now);
///     if (budget.is_due(now)) { ...; budget.spent(seconds, now); }
class TimeBudget {
 public:
    /// @param share  of the time that may be spent, 0 to 1; 0: never
    /// @param every  (s) between two times
    /// @param start  (s) the clock now
    TimeBudget(double share, double every, double start)
        : m_share(share), m_every(every), m_start(start), m_last(start) {}

    /// @param now  (s)
    bool is_due(double now) const {
        const bool affordable = m_spent + m_last_cost <= m_share * (now - m_start + m_last_cost);
        return m_share > 0.0 && now - m_last >= m_every && affordable;
    }

    /// @param seconds  that it took
    /// @param now      (s) at its end
    void spent(double seconds, double now) {
        m_spent += seconds;
        m_last_cost = seconds;
        m_last = now;
    }

    double total() const { return m_spent; }  ///< (s)

 private:
    double m_share, m_every, m_start, m_last;
    double m_spent = 0.0, m_last_cost = 0.0;
};

}  // namespace cloth
