#include "cli/frame_writer.h"

#include "core/parallel.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace ibl {
namespace {

constexpr int kMostThreads = 16; // each has a picture in memory, and there are as many that wait

} // namespace

FrameWriter::FrameWriter(int threads) {
    const int count = std::min(threadCount(threads), kMostThreads);
    under_way_limit_ = 2 * static_cast<std::size_t>(count);
    for (int i = 0; i < count; ++i)
        threads_.emplace_back([this] { work(); });
}

FrameWriter::~FrameWriter() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
}

void FrameWriter::add(Encode encode) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return failure_ || handed_in_ - named_ < under_way_limit_; });
    if (failure_) std::rethrow_exception(failure_);
    waiting_.push_back(std::move(encode));
    ++handed_in_;
    changed_.notify_all();
}

std::vector<FrameWriter::Written> FrameWriter::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return failure_ || named_ == handed_in_; });
    if (failure_) std::rethrow_exception(failure_);
    return written_;
}

void FrameWriter::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return ended_ || !waiting_.empty(); });
        if (waiting_.empty()) return;
        const std::size_t number = handed_in_ - waiting_.size();
        const Encode encode = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        write(number, encode);
        lock.lock();
    }
}

void FrameWriter::write(std::size_t number, const Encode& encode) {
    OutputSet outputs;
    Written written;
    std::exception_ptr problem;
    try {
        const auto begin = std::chrono::steady_clock::now();
        written.losses = encode(outputs);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        written.seconds = taken.count();
    } catch (...) {
        problem = std::current_exception();
    }
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return named_ == number; });
    if (!problem && !failure_) {
        lock.unlock(); // it is this frame's turn until named_ moves on
        try {
            outputs.commit();
        } catch (...) {
            problem = std::current_exception();
        }
        lock.lock();
        written_.push_back(written);
    }
    if (problem && !failure_) failure_ = problem;
    ++named_;
    changed_.notify_all();
}

} // namespace ibl
