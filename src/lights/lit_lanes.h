// A lat-long's pixels a few at a time, and doubles rounded to 64-bit integers.
#pragma once

#include "core/simd.h"
#include "image/pixel_lanes.h"
#include "lights/light.h"

#include <algorithm>
#include <cstdint>

namespace ibl {

typedef std::int64_t LongLanes __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

IBL_INLINE Lanes loadLanes(const double* from) {
    Lanes v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}

IBL_INLINE double sumOf(const Lanes& v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

IBL_INLINE void addTo(double* sums, const Lanes& values) {
    const Lanes total = loadLanes(sums) + values;
    __builtin_memcpy(sums, &total, sizeof total);
}

/// Asks for pixels that come 2 KiB later: the machine's own reading ahead stops at every page.
IBL_INLINE void fetchAhead(const float* rgb) {
    __builtin_prefetch(rgb + 512);
}

/// kLanes RGB pixels.
struct PixelLanes {
    Lanes red, green, blue;
};

IBL_INLINE PixelLanes pixelLanes(const float* rgb) {
    return {loadPixels<0>(rgb), loadPixels<1>(rgb), loadPixels<2>(rgb)};
}

/// The last `count` pixels of a row, fewer than kLanes, and black ones after them.
IBL_INLINE PixelLanes lastPixelLanes(const float* rgb, int count) {
    float pixels[3 * kLanes]{};
    std::copy_n(rgb, 3 * count, pixels);
    return pixelLanes(pixels);
}

/// Pixels [end - count, end) of a row, count < kLanes <= end, and black ones before them: quicker
/// than lastPixelLanes(), where the row begins far enough left.
IBL_INLINE PixelLanes endPixelLanes(const float* row, int end, int count) {
    constexpr double kKeep[2 * kLanes] = {0, 0, 0, 0, 1, 1, 1, 1};
    const PixelLanes p = pixelLanes(row + 3 * (end - kLanes));
    const Lanes keep = loadLanes(kKeep + count);
    return {p.red * keep, p.green * keep, p.blue * keep};
}

IBL_INLINE Lanes luminanceOf(const PixelLanes& p) {
    return kLuminanceRed * p.red + kLuminanceGreen * p.green + kLuminanceBlue * p.blue;
}

/// litLuminance() of each pixel.
IBL_INLINE Lanes litLuminance(const PixelLanes& p) {
    const Lanes y = luminanceOf(p);
    return y > 0 ? y : Lanes{};
}

IBL_INLINE Lanes absoluteLuminance(const PixelLanes& p) {
    const Lanes y = luminanceOf(p);
    return y > 0 ? y : -y;
}

/// To the nearest integers, of magnitudes up to 2^62. With v = 2^32 high + low, a double of
/// 1.5 2^52 + high has the integer `high` in its low bits, and so has 1.5 2^52 + low. The bits
/// above go over the top, so integers without sign add.
IBL_INLINE LongLanes rounded(const Lanes& v) {
    typedef std::uint64_t Bits __attribute__((vector_size(sizeof(LongLanes))));
    const Lanes magic = Lanes{} + 0x1.8p52;
    const Lanes high = v * 0x1p-32 + magic;
    const Lanes low = (v - (high - magic) * 0x1p32) + magic;
    return reinterpret_cast<LongLanes>(
        (reinterpret_cast<Bits>(high) << 32) +
        (reinterpret_cast<Bits>(low) - reinterpret_cast<Bits>(magic)));
}

} // namespace ibl
