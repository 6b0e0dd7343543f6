// Vectors of doubles for the transforms: one source, compiled for several instruction sets.
//
// `Lanes` is GCC's vector extension, lowered to whatever the machine has. A function marked
// IBL_MULTIVERSION is compiled for AVX-512, for AVX2 with FMA and for the baseline, and the right
// one is bound when the program starts; what it calls must be IBL_INLINE to be compiled along with
// it. Only in the files that do so may products and sums be contracted (CMakeLists.txt says which).
#pragma once

#include <cstdint>
#include <memory>
#include <new>
#include <vector>

namespace ibl {

inline constexpr int kLanes = 8;
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
typedef std::int64_t LaneMask __attribute__((vector_size(kLanes * sizeof(double))));

#if defined(__x86_64__)
#define IBL_MULTIVERSION [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#else
#define IBL_MULTIVERSION
#endif
#define IBL_INLINE [[gnu::always_inline]] inline

/// A vector's worth of complex numbers.
struct ComplexLanes {
    Lanes re;
    Lanes im;
};

/// Memory for vectors. The alignment that a vector type needs is the compiler's choice for each
/// instruction set, so `alignof` in baseline code does not tell it.
template <class T>
struct LaneAllocator : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = LaneAllocator<U>;
    };
    T* allocate(std::size_t n) {
        return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{sizeof(Lanes)}));
    }
    void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{sizeof(Lanes)}); }
};

template <class T>
using LaneVector = std::vector<T, LaneAllocator<T>>;

} // namespace ibl
