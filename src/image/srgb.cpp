#include "image/srgb.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ibl {
namespace {

double decode(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

/// Rounding without a power or a branch a pixel: the upper bits of a float choose a cell, 128 an
/// octave, which has room for no more than one step from a code to the next (the last octave has
/// 0.66 of them); added to the cell, the lower bits carry into the code from the step on. Values
/// below 2^-13 encode to less than half a code.
class RoundingTable {
public:
    RoundingTable() {
        std::array<std::uint32_t, 257> starts{}; // the least float that rounds to each code
        for (std::size_t c = 1; c < 256; ++c) {
            const double exact = decode((static_cast<double>(c) - 0.5) / 255);
            float start = static_cast<float>(exact);
            if (start < exact) start = std::nextafter(start, 2.0F);
            starts[c] = std::bit_cast<std::uint32_t>(start);
        }
        starts[256] = std::bit_cast<std::uint32_t>(2.0F);
        std::uint32_t code = 0;
        for (std::uint32_t b = kFirst; b < kEnd; ++b) {
            const std::uint32_t least = b << kShift, beyond = (b + 1) << kShift;
            while (least >= starts[code + 1])
                ++code;
            const std::uint32_t step = starts[code + 1];
            cells_[b - kFirst] = (code << kShift) + (step < beyond ? beyond - step : 0);
        }
    }

    std::uint8_t code(float linear) const {
        // As integers, in the same order, what is clipped costs no branch.
        auto bits = std::bit_cast<std::int32_t>(linear);
        bits &= -static_cast<std::int32_t>(bits <= kInfinity); // NaN is 0
        bits = std::min(std::max(bits, kLeast), kMost);
        const std::uint32_t lower = bits & ((1 << kShift) - 1);
        return static_cast<std::uint8_t>((cells_[(bits >> kShift) - kFirst] + lower) >> kShift);
    }

private:
    static constexpr int kShift = 23 - 7;
    static constexpr auto kInfinity = std::bit_cast<std::int32_t>(HUGE_VALF);
    static constexpr auto kLeast = std::bit_cast<std::int32_t>(0x1p-13F);      // code 0
    static constexpr auto kMost = std::bit_cast<std::int32_t>(0x1.fffffep-1F); // code 255
    static constexpr std::uint32_t kFirst = kLeast >> kShift, kEnd = (kMost >> kShift) + 1;

    std::array<std::uint32_t, kEnd - kFirst> cells_{};
};

const RoundingTable& roundingTable() {
    static const RoundingTable table;
    return table;
}

} // namespace

float srgbToLinear(float encoded) {
    return static_cast<float>(decode(encoded));
}

double linearToSrgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

std::uint8_t linearToSrgb8(float linear) {
    return roundingTable().code(linear);
}

void linearToSrgb8(const float* __restrict linear, std::size_t count,
                   std::uint8_t* __restrict codes) {
    const RoundingTable& table = roundingTable();
    for (std::size_t i = 0; i < count; ++i)
        codes[i] = table.code(linear[i]);
}

} // namespace ibl
