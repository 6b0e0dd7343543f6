#include "image/image.h"

#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace ibl {
namespace {

constexpr std::size_t kHugePage = 2 << 20;

} // namespace

void* allocatePixels(std::size_t bytes) {
    const bool large = bytes >= 4 * kHugePage;
    const std::size_t whole = (bytes + kHugePage - 1) / kHugePage * kHugePage;
    void* memory = large ? std::aligned_alloc(kHugePage, whole) : std::malloc(bytes);
    if (!memory) throw std::bad_alloc();
    if (large) ::madvise(memory, whole, MADV_HUGEPAGE); // a wish; the memory is there without it
    return memory;
}

void freePixels(void* memory) {
    std::free(memory);
}

} // namespace ibl
