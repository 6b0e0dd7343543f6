// Parallel loops whose result does not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace ibl {

/// Number of threads meant by `requested`: itself when positive, otherwise that of the machine
/// (what the scheduler lets this process use).
int threadCount(int requested);

/// Calls `body(i)` once for every i in [0, count), on at most `threads` threads (0: as many as the
/// machine has), in no particular order. A body that writes only what belongs to its own i gives
/// the same bytes for any number of threads; sums are taken per i and added afterwards in order.
/// The first exception thrown by a body is rethrown here once all threads have stopped. A loop
/// begun while another one runs, in its body or on another thread, has the calling thread alone.
void parallelFor(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

/// The same over runs of consecutive indices: `body(begin, end)`, for bodies too small to be called
/// one by one. Runs have `grain` indices, the last one fewer; they do not depend on `threads`.
void parallelForRuns(std::size_t count, std::size_t grain, int threads,
                     const std::function<void(std::size_t, std::size_t)>& body);

} // namespace ibl
