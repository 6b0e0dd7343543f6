// Pixels as vectors.
#pragma once

#include "core/simd.h"

namespace ibl {

typedef float FloatLanes __attribute__((vector_size(kLanes * sizeof(float))));

/// kLanes floats. Written out, since of __builtin_convertvector GCC 12 makes three instructions.
IBL_INLINE Lanes widened(const float* from) {
    FloatLanes v;
    __builtin_memcpy(&v, from, sizeof v);
    return Lanes{v[0], v[1], v[2], v[3]};
}

/// One channel of kLanes RGB pixels from `row` on. In the three vectors of doubles that hold the
/// pixels no two values of a channel stand at the same place: two blends and one permutation.
template <int Channel>
IBL_INLINE Lanes loadPixels(const float* row) {
    const Lanes a = widened(row), b = widened(row + 4), c = widened(row + 8);
    if constexpr (Channel == 0) {
        const Lanes v =
            __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 1, 6, 3), c, 0, 5, 2, 3);
        return __builtin_shufflevector(v, v, 0, 3, 2, 1);
    } else if constexpr (Channel == 1) {
        const Lanes v =
            __builtin_shufflevector(__builtin_shufflevector(a, b, 4, 1, 2, 7), c, 0, 1, 6, 3);
        return __builtin_shufflevector(v, v, 1, 0, 3, 2);
    } else {
        const Lanes v =
            __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 5, 2, 3), c, 4, 1, 2, 7);
        return __builtin_shufflevector(v, v, 2, 1, 0, 3);
    }
}

} // namespace ibl
