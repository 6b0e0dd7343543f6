// Writing frames while later ones are drawn.
#pragma once

#include "image/output_set.h"
#include "image/write.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace ibl {

/// Encodes frames on threads of its own, each frame by one of them, and gives them their names one
/// by one, in the order in which they were handed in: whoever sees a frame sees all before it, each
/// whole. After a failure no later frame gets its name.
class FrameWriter {
public:
    /// Adds a frame's files to the set, and says what its format could not hold.
    using Encode = std::function<WriteLosses(OutputSet&)>;

    struct Written {
        WriteLosses losses;
        double seconds = 0; ///< of encoding
    };

    /// At most `threads` frames are encoded at a time (0: as many as the machine has threads), and
    /// as many more wait.
    explicit FrameWriter(int threads);
    /// Finishes what was handed in, so that a run that fails at a frame has written all before it.
    ~FrameWriter();
    FrameWriter(const FrameWriter&) = delete;
    FrameWriter& operator=(const FrameWriter&) = delete;

    /// Hands in a frame; waits while too many are under way. Throws what an earlier frame's writing
    /// has thrown.
    void add(Encode encode);

    /// Waits for all of them, throws what the first that failed threw, and otherwise tells of each.
    std::vector<Written> finish();

private:
    void work();
    void write(std::size_t number, const Encode& encode);

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Encode> waiting_; ///< the last of all that were handed in
    std::vector<Written> written_;
    std::size_t handed_in_ = 0;
    std::size_t named_ = 0; ///< frames that have their names, or failed to get them
    std::size_t under_way_limit_;
    bool ended_ = false;
    std::exception_ptr failure_;
    std::vector<std::jthread> threads_; ///< last: they end before the rest goes
};

} // namespace ibl
