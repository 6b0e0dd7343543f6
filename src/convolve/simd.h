// Vectors for the transforms. Only in the files that use them may products and sums be contracted
// (CMakeLists.txt says which).
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

namespace ibl {

/// A vector's worth of complex numbers.
struct ComplexLanes {
    Lanes re;
    Lanes im;
};

/// Memory for vectors, aligned to a cache line. The alignment that a vector type needs is the
/// compiler's choice for each instruction set, so `alignof` in baseline code does not tell it.
/// Elements that are given no value are left as they are: whoever resizes writes them all.
template <class T>
struct LaneAllocator : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = LaneAllocator<U>;
    };
    T* allocate(std::size_t n) {
        return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64}));
    }
    void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{64}); }
    template <class U>
    void construct(U* p) {
        ::new (static_cast<void*>(p)) U;
    }
    template <class U, class... Arguments>
    void construct(U* p, Arguments&&... arguments) {
        ::new (static_cast<void*>(p)) U(std::forward<Arguments>(arguments)...);
    }
};

template <class T>
using LaneVector = std::vector<T, LaneAllocator<T>>;

/// Rows become columns.
IBL_INLINE void transpose(Lanes (&x)[kLanes]) {
    const Lanes a = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6);
    const Lanes b = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7);
    const Lanes c = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6);
    const Lanes d = __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);
    x[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    x[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    x[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    x[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

} // namespace ibl
