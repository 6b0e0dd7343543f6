// Vectors of doubles: one source, compiled for several instruction sets.
//
// `Lanes` is GCC's vector extension, lowered to whatever the machine has. A function marked
// IBL_MULTIVERSION is compiled for AVX-512, for AVX2 with FMA and for the baseline, and the right
// one is bound when the program starts; what it calls must be IBL_INLINE to be compiled along with
// it. Vectors wider than the baseline's registers are never passed between functions that are not
// inlined.
#pragma once

namespace ibl {

/// As wide as AVX2's registers: wider vectors would be kept in memory there.
inline constexpr int kLanes = 4;
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));

#if defined(__x86_64__)
#define IBL_MULTIVERSION [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#else
#define IBL_MULTIVERSION
#endif
#define IBL_INLINE [[gnu::always_inline]] inline

} // namespace ibl
