#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <sched.h>

namespace ibl {

namespace {

/// The threads of all parallel loops of the process, each made when first needed and kept: a loop
/// of a few milliseconds would lose a third of what a second thread brings to making one, since the
/// scheduler leaves a new thread for a while on the core of the thread that made it.
class Workers {
public:
    /// `work` once on this thread and once on each of `others` more; returns when all have
    /// returned. `work` must not throw. False, and nothing done, while another loop has the
    /// workers.
    bool run(std::size_t others, const std::function<void()>& work) {
        if (taken_.test_and_set(std::memory_order_acquire)) return false;
        while (threads_.size() < others)
            threads_.emplace_back(
                [this, index = threads_.size(), seen = loops_.load()] { serve(index, seen); });
        work_ = &work;
        others_ = others;
        running_ = threads_.size();
        ++loops_;
        loops_.notify_all();
        work();
        for (std::size_t left = running_; left != 0; left = running_)
            running_.wait(left);
        taken_.clear(std::memory_order_release);
        return true;
    }

private:
    void serve(std::size_t index, std::size_t seen) {
        for (;;) {
            loops_.wait(seen);
            seen = loops_;
            if (index < others_) (*work_)();
            if (--running_ == 0) running_.notify_one();
        }
    }

    std::atomic_flag taken_;
    std::vector<std::thread> threads_;
    std::atomic<std::size_t> loops_{0};   ///< loops begun
    std::atomic<std::size_t> running_{0}; ///< threads that have not yet done with the last one
    const std::function<void()>* work_ = nullptr;
    std::size_t others_ = 0;
};

} // namespace

int threadCount(int requested) {
    if (requested > 0) return requested;
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
        return std::max(1, CPU_COUNT(&allowed));
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallelFor(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
    const std::size_t workers = std::min<std::size_t>(count, threadCount(threads));
    if (workers <= 1) {
        for (std::size_t i = 0; i < count; ++i)
            body(i);
        return;
    }
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const std::function<void()> work = [&] {
        try {
            for (std::size_t i = next++; i < count; i = next++)
                body(i);
        } catch (...) {
            next = count;
            const std::lock_guard lock(failure_mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    // Never destroyed: its threads wait until the process ends.
    static Workers& shared = *new Workers;
    if (!shared.run(workers - 1, work)) work();
    if (failure) std::rethrow_exception(failure);
}

void parallelForRuns(std::size_t count, std::size_t grain, int threads,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    const std::size_t runs = (count + grain - 1) / grain;
    parallelFor(runs, threads,
                [&](std::size_t run) { body(run * grain, std::min(count, (run + 1) * grain)); });
}

} // namespace ibl
