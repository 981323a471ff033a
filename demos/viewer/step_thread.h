#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace cloth {

/// A thread that does one job after another, so that a window stays alive during long steps. It is
/// one thread for life: OpenMP keeps a team for each.
class StepThread {
 public:
    StepThread();
    ~StepThread();  ///< waits for the job that is being done

    bool is_idle();
    /// To be called when idle. The job must not throw.
    void start(std::function<void()> job);
    void wait();  ///< until idle

 private:
    void run();

    std::mutex m_mutex;
    std::condition_variable m_changed;
    std::function<void()> m_job;
    bool m_end = false;
    std::thread m_thread;
};

}  // namespace cloth
