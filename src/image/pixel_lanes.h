// Pixels as vectors.
#pragma once

#include "core/simd.h"

namespace ibl {

typedef float FloatLanes __attribute__((vector_size(kLanes * sizeof(float))));

/// One channel of kLanes RGB pixels from `row` on.
template <int Channel>
IBL_INLINE Lanes loadPixels(const float* row) {
    FloatLanes a, b, c;
    __builtin_memcpy(&a, row, sizeof a);
    __builtin_memcpy(&b, row + 4, sizeof b);
    __builtin_memcpy(&c, row + 8, sizeof c);
    FloatLanes channel;
    if constexpr (Channel == 0) {
        channel = __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 3, 6, 6), c, 0, 1, 2, 5);
    } else if constexpr (Channel == 1) {
        channel = __builtin_shufflevector(__builtin_shufflevector(a, b, 1, 4, 7, 7), c, 0, 1, 2, 6);
    } else {
        channel = __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 5, 5, 5), c, 0, 1, 4, 7);
    }
    return __builtin_convertvector(channel, Lanes);
}

} // namespace ibl
