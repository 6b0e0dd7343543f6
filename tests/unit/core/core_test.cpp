#include "core/error.h"
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace ibl {
namespace {

TEST(Error, StaysOneLine) {
    EXPECT_STREQ(inputError("a\nb.exr", "is\tbad").what(), "a b.exr: is bad");
    EXPECT_EQ(inputError("a", "b").code(), ExitCode::input);
    EXPECT_EQ(outputError("a", "b").code(), ExitCode::output);
}

TEST(Parallel, VisitsEveryIndexOnce) {
    for (const int threads : {0, 1, 2, 7}) {
        std::vector<std::atomic<int>> visits(1000);
        parallelFor(visits.size(), threads, [&](std::size_t i) { ++visits[i]; });
        for (const auto& n : visits)
            EXPECT_EQ(n, 1);
    }
}

TEST(Parallel, RunsCoverTheRangeWhateverTheThreads) {
    for (const int threads : {1, 3}) {
        std::vector<std::atomic<int>> visits(103);
        parallelForRuns(visits.size(), 10, threads, [&](std::size_t begin, std::size_t end) {
            EXPECT_EQ(begin % 10, 0u);
            for (std::size_t i = begin; i < end; ++i)
                ++visits[i];
        });
        for (const auto& n : visits)
            EXPECT_EQ(n, 1);
    }
}

TEST(Parallel, RethrowsTheBodysException) {
    for (const int threads : {1, 4}) {
        EXPECT_THROW(parallelFor(100, threads,
                                 [](std::size_t i) {
                                     if (i == 42) throw Error(ExitCode::missing, "x");
                                 }),
                     Error);
    }
}

TEST(Parallel, LoopsWithinLoopsAndBesideThem) {
    std::vector<std::atomic<int>> visits(2 * 50 * 30);
    const auto loops = [&](std::size_t first) {
        for (int round = 0; round < 20; ++round) {
            parallelFor(50, 2 + round % 3, [&](std::size_t i) {
                parallelFor(30, 3, [&](std::size_t j) { ++visits[first + 30 * i + j]; });
            });
        }
    };
    {
        const std::jthread other(loops, visits.size() / 2);
        loops(0);
    }
    for (const auto& n : visits)
        EXPECT_EQ(n, 20);
}

TEST(Parallel, AtMostAsManyThreadsAsAsked) {
    parallelFor(100, 8, [](std::size_t) {}); // makes seven threads, which wait for other loops too
    std::mutex mutex;
    std::set<std::thread::id> ids;
    parallelFor(200, 2, [&](std::size_t) {
        const std::lock_guard lock(mutex);
        ids.insert(std::this_thread::get_id());
    });
    EXPECT_LE(ids.size(), 2u);
}

TEST(Parallel, NothingToDo) {
    parallelFor(0, 4, [](std::size_t) { FAIL(); });
}

} // namespace
} // namespace ibl
