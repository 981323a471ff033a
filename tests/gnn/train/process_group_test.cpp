#include "gnn/train/process_group.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <thread>

#include "data/core/errors.h"
#include "tests/gnn/train/tiny_training.h"

namespace cloth::process_group_test {
namespace {

/// Runs `work` as `size` processes would, each in a thread of its own; hands on what they throw.
void run_as_processes(int size, const std::function<void(const ProcessGroup&)>& work) {
    const int port = ProcessGroup::free_port();
    std::vector<std::exception_ptr> errors(static_cast<size_t>(size));
    std::vector<std::thread> threads;
    for (int rank = 0; rank < size; ++rank)
        threads.emplace_back([&, rank] {
            try {
                work(ProcessGroup(rank, size, "127.0.0.1", port, 60.0));
            } catch (...) {
                errors[static_cast<size_t>(rank)] = std::current_exception();
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
}

TEST(ProcessGroup, SumsTensorsOfAllWithEqualBits) {
    for (const int size : {1, 2, 3}) {
        std::vector<torch::Tensor> sums(static_cast<size_t>(size));
        run_as_processes(size, [&](const ProcessGroup& group) {
            EXPECT_EQ(group.size(), size);
            torch::manual_seed(7);
            torch::Tensor tensor = torch::sin(torch::arange(10000) * (1.0 + group.rank()));
            group.sum(tensor);
            sums[static_cast<size_t>(group.rank())] = tensor;
        });
        torch::Tensor expected = torch::zeros({10000});
        for (int rank = 0; rank < size; ++rank)
            expected += torch::sin(torch::arange(10000) * (1.0 + rank));
        EXPECT_TRUE(torch::allclose(sums[0], expected, 1e-5, 1e-6));
        for (const torch::Tensor& sum : sums) EXPECT_TRUE(torch::equal(sum, sums[0]));
    }
}

TEST(ProcessGroup, HandsBytesOn) {
    run_as_processes(3, [](const ProcessGroup& group) {
        const std::string own(static_cast<size_t>(1000 * group.rank()), 'a' + group.rank());
        EXPECT_EQ(group.from_first(group.is_first() ? "hello" : "not heard"), "hello");
        EXPECT_EQ(group.from_first(""), "");
        const std::vector<std::string> all = group.from_all(own);
        ASSERT_EQ(all.size(), 3u);
        EXPECT_EQ(all[0], "");
        EXPECT_EQ(all[1], std::string(1000, 'b'));
        EXPECT_EQ(all[2], std::string(2000, 'c'));
    });
}

TEST(ProcessGroup, SaysThatAnotherOneHasEnded) {
    EXPECT_THROW(run_as_processes(2,
                                  [](const ProcessGroup& group) {
                                      torch::Tensor tensor = torch::ones({5});
                                      group.sum(tensor);
                                      if (group.rank() == 1) return;
                                      group.sum(tensor);
                                  }),
                 ProcessGroupError);
}

TEST(ProcessGroup, SaysThatTheOthersDoNotCome) {
    EXPECT_THROW(ProcessGroup(0, 2, "127.0.0.1", ProcessGroup::free_port(), 1.0),
                 ProcessGroupError);
    EXPECT_THROW(ProcessGroup(1, 2, "127.0.0.1", ProcessGroup::free_port(), 1.0),
                 ProcessGroupError);
}

void set(const char* size, const char* rank, const char* address, const char* port) {
    const auto one = [](const char* name, const char* value) {
        if (value == nullptr)
            unsetenv(name);
        else
            setenv(name, value, 1);
    };
    one("WORLD_SIZE", size);
    one("RANK", rank);
    one("MASTER_ADDR", address);
    one("MASTER_PORT", port);
}

TEST(ProcessGroup, RefusesAnEnvironmentThatMakesNoSense) {
    set(nullptr, "1", nullptr, nullptr);
    EXPECT_EQ(ProcessGroup::from_environment().size(), 1);
    set("1", "0", "127.0.0.1", "2000");
    EXPECT_EQ(ProcessGroup::from_environment().size(), 1);
    const std::vector<std::array<const char*, 4>> bad = {
        {"0", "0", "127.0.0.1", "2000"},     {"two", "0", "127.0.0.1", "2000"},
        {"2", "2", "127.0.0.1", "2000"},     {"2", "-1", "127.0.0.1", "2000"},
        {"2", nullptr, "127.0.0.1", "2000"}, {"2", "", "127.0.0.1", "2000"},
        {"2", "0", nullptr, "2000"},         {"2", "0", "127.0.0.1", nullptr},
        {"2", "0", "127.0.0.1", "70000"},    {"2", "0.5", "127.0.0.1", "2000"},
        {"999999", "0", "127.0.0.1", "2000"}};
    for (const auto& [size, rank, address, port] : bad) {
        set(size, rank, address, port);
        EXPECT_THROW(ProcessGroup::from_environment(), ArgumentError);
    }
    set(nullptr, nullptr, nullptr, nullptr);
}

TrainerSettings tiny(const std::string& name) {
    TrainerSettings settings = test::tiny_training("process_group_" + name, "kicks");
    settings.recipe.kicks.share = 0.5;
    settings.recipe.max_rollout = 2;
    settings.recipe.rollout_growth = 4;
    settings.validation_share = 0.0;
    settings.iterations = 16;
    settings.pool = 3;
    settings.batch = 2;
    settings.freeze_statistics = 6;
    return settings;
}

torch::Tensor numbers(Trainer& trainer) {
    return trainer.network().parameters().flat().detach().clone();
}

/// Trains until the end with so many processes; they must agree.
torch::Tensor train(TrainerSettings settings, int processes, bool resume) {
    std::vector<torch::Tensor> results(static_cast<size_t>(processes));
    run_as_processes(processes, [&](const ProcessGroup& group) {
        Trainer trainer(settings, group);
        EXPECT_EQ(trainer.resume(), resume);
        trainer.run(std::atomic<bool>{false});
        EXPECT_EQ(trainer.iteration(), settings.iterations);
        results[static_cast<size_t>(group.rank())] = numbers(trainer);
    });
    for (const torch::Tensor& result : results) EXPECT_TRUE(torch::equal(result, results[0]));
    return results[0];
}

TEST(DistributedTraining, EqualsOneProcessWithTheSameBatch) {
    const torch::Tensor alone = train(tiny("alone"), 1, false);
    const torch::Tensor two = train(tiny("two"), 2, false);
    // Statistics of the features are summed in another order; the rest is the same.
    EXPECT_TRUE(torch::allclose(alone, two, 1e-4, 1e-6));
    TrainerSettings single = tiny("single");
    single.batch = 1;
    EXPECT_FALSE(torch::allclose(alone, train(single, 1, false), 1e-3, 1e-5));
}

TEST(DistributedTraining, OfStartWeightsEqualsOneProcessBitForBit) {
    const TrainerSettings first = tiny("first");
    train(first, 1, false);
    const auto resumed_from_weights = [&](const std::string& name, int processes) {
        TrainerSettings settings = tiny(name);
        settings.start_weights = first.out + "/weights.safetensors";
        return train(settings, processes, false);
    };
    EXPECT_TRUE(torch::equal(resumed_from_weights("from_1", 1), resumed_from_weights("from_2", 2)));
}

TEST(DistributedTraining, IsResumedByAnotherNumberOfProcesses) {
    const TrainerSettings straight = tiny("straight");
    const torch::Tensor expected = train(straight, 1, false);
    const TrainerSettings settings = tiny("changed");
    run_as_processes(2, [&](const ProcessGroup& group) {
        Trainer trainer(settings, group);
        while (trainer.iteration() < 7) trainer.iterate();
        trainer.save();
    });
    EXPECT_TRUE(torch::allclose(train(settings, 1, true), expected, 1e-4, 1e-6));
}

TEST(DistributedTraining, StopsTogether) {
    const TrainerSettings settings = tiny("stopped");
    run_as_processes(2, [&](const ProcessGroup& group) {
        Trainer trainer(settings, group);
        for (int k = 0; k < 3; ++k) trainer.iterate();
        trainer.run(std::atomic<bool>{group.rank() == 1});  // the second one is told to stop
        EXPECT_EQ(trainer.iteration(), 3);
    });
    EXPECT_TRUE(std::filesystem::exists(settings.out + "/checkpoint.pt"));
    train(settings, 2, true);
}

TEST(DistributedTraining, RefusesABatchThatCannotBeShared) {
    run_as_processes(2, [](const ProcessGroup& group) {
        TrainerSettings settings = tiny("odd");
        settings.batch = 3;
        EXPECT_THROW(Trainer(settings, group), ArgumentError);
        settings.batch = 0;
        EXPECT_THROW(Trainer(settings, group), ArgumentError);
    });
}

}  // namespace
}  // namespace cloth::process_group_test
