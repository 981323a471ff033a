#include "demos/viewer/step_thread.h"

#include <utility>

namespace cloth {

StepThread::StepThread() : m_thread([this] { run(); }) {
}

StepThread::~StepThread() {
    {
        const std::lock_guard<std::mutex> lock(m_mutex);
        m_end = true;
    }
    m_changed.notify_all();
    m_thread.join();
}

bool StepThread::is_idle() {
    const std::lock_guard<std::mutex> lock(m_mutex);
    return !m_job;
}

void StepThread::start(std::function<void()> job) {
    {
        const std::lock_guard<std::mutex> lock(m_mutex);
        m_job = std::move(job);
    }
    m_changed.notify_all();
}

void StepThread::wait() {
    std::unique_lock<std::mutex> lock(m_mutex);
    m_changed.wait(lock, [this] { return !m_job; });
}

void StepThread::run() {
    std::unique_lock<std::mutex> lock(m_mutex);
    for (;;) {
        m_changed.wait(lock, [this] { return m_job || m_end; });
        if (!m_job) return;
        lock.unlock();
        m_job();
        lock.lock();
        m_job = nullptr;
        m_changed.notify_all();
    }
}

}  // namespace cloth
