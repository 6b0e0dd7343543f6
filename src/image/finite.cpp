#include "image/finite.h"

#include <bit>
#include <cstdint>

namespace ibl {

bool allFinite(std::span<const float> values) {
    constexpr std::uint32_t kExponent = 0x7f800000; // all of it set: no number, or infinite
    std::uint32_t bad = 0;                          // no early end, so that lanes can be compared
    for (const float v : values)
        bad |= (std::bit_cast<std::uint32_t>(v) & kExponent) == kExponent;
    return bad == 0;
}

} // namespace ibl
