#include "demos/viewer/step_thread.h"

#include <gtest/gtest.h>

#include <vector>

namespace cloth::viewer_thread_test {

TEST(ViewerThread, DoesOneJobAfterAnotherInOneThread) {
    StepThread thread;
    EXPECT_TRUE(thread.is_idle());
    std::vector<std::thread::id> ids;
    for (int k = 0; k < 100; ++k) {
        thread.start([&] { ids.push_back(std::this_thread::get_id()); });
        thread.wait();
        ASSERT_TRUE(thread.is_idle());
    }
    ASSERT_EQ(ids.size(), 100u);
    for (const auto& id : ids) EXPECT_EQ(id, ids[0]);
    EXPECT_NE(ids[0], std::this_thread::get_id());
}

TEST(ViewerThread, IsBusyUntilTheJobIsDone) {
    StepThread thread;
    std::mutex gate;
    gate.lock();
    thread.start([&] { const std::lock_guard<std::mutex> lock(gate); });
    EXPECT_FALSE(thread.is_idle());
    gate.unlock();
    thread.wait();
    EXPECT_TRUE(thread.is_idle());
}

TEST(ViewerThread, EndsAfterTheJobThatIsBeingDone) {
    bool done = false;
    {
        StepThread thread;
        thread.start([&] { done = true; });
    }
    EXPECT_TRUE(done);
}

}  // namespace cloth::viewer_thread_test
