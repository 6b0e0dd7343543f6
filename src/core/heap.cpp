#include "core/heap.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <malloc.h>
#include <sys/mman.h>

namespace ibl {

void keepHeap() {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
    constexpr int kKept = 512 << 20;
    constexpr int kMore = 1 << 30;
    constexpr int kOwnMapping = 256 << 20; // larger blocks are mappings of their own, as ever
    constexpr std::uintptr_t kLargePage = 2 << 20;
    mallopt(M_TRIM_THRESHOLD, kMore);       // or the block's end would be given back at once
    mallopt(M_MMAP_THRESHOLD, kMore);       // or it would be no part of the heap
    if (void* block = std::malloc(kKept)) { // address space only: no page of it is touched
        const auto begin =
            (reinterpret_cast<std::uintptr_t>(block) + kLargePage - 1) / kLargePage * kLargePage;
        madvise(reinterpret_cast<void*>(begin), kKept - kLargePage, MADV_HUGEPAGE);
        std::free(block);
    }
    mallopt(M_MMAP_THRESHOLD, kOwnMapping);
#endif
}

} // namespace ibl
