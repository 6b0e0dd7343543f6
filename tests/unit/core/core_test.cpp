#include "core/error.h"
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
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

TEST(Parallel, NothingToDo) {
    parallelFor(0, 4, [](std::size_t) { FAIL(); });
}

} // namespace
} // namespace ibl
