// How far a long piece of work has come.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>

namespace ibl {

/// Called with the part that is done, in [0, 1].
using TellProgress = std::function<void(double)>;

/// Counts steps of work as any thread finishes them and tells of each percent, one call at a time.
class Progress {
public:
    Progress(TellProgress tell, std::size_t steps) : tell_(std::move(tell)), steps_(steps) {}

    void step() {
        if (!tell_) return;
        const std::lock_guard lock(mutex_);
        ++done_;
        const std::size_t percent = 100 * done_ / steps_;
        if (percent != told_) tell_(static_cast<double>(done_) / static_cast<double>(steps_));
        told_ = percent;
    }

private:
    TellProgress tell_;
    std::size_t steps_;
    std::size_t done_ = 0;
    std::size_t told_ = 0;
    std::mutex mutex_;
};

} // namespace ibl
