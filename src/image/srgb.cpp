#include "image/srgb.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

namespace ibl {
namespace {

double decode(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

/// Rounding without a power a pixel. starts[c] is the least float that rounds to code c (the
/// inverse of c - 1/2, rounded up); codes[b] is the code of the least float whose upper bits are b,
/// from where at most a few steps remain. Values below 2^-13 encode to less than half a code.
struct RoundingTable {
    static constexpr int kShift = 23 - 6; // 64 entries an octave
    static constexpr std::uint32_t kFirst = std::bit_cast<std::uint32_t>(0x1p-13F) >> kShift;
    static constexpr std::uint32_t kLast = std::bit_cast<std::uint32_t>(1.0F) >> kShift;

    std::array<float, 257> starts{};
    std::array<std::uint8_t, kLast - kFirst> codes{};

    RoundingTable() {
        for (std::size_t c = 1; c < 256; ++c) {
            const double exact = decode((static_cast<double>(c) - 0.5) / 255);
            starts[c] = static_cast<float>(exact);
            if (starts[c] < exact) starts[c] = std::nextafter(starts[c], 2.0F);
        }
        starts[256] = 2;
        std::size_t code = 0;
        for (std::uint32_t b = kFirst; b < kLast; ++b) {
            const float least = std::bit_cast<float>(b << kShift);
            while (least >= starts[code + 1])
                ++code;
            codes[b - kFirst] = static_cast<std::uint8_t>(code);
        }
    }

    std::uint8_t code(float linear) const {
        if (!(linear >= 0x1p-13F)) return 0;
        if (linear >= 1) return 255;
        std::size_t c = codes[(std::bit_cast<std::uint32_t>(linear) >> kShift) - kFirst];
        while (linear >= starts[c + 1])
            ++c;
        return static_cast<std::uint8_t>(c);
    }
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

void linearToSrgb8(const float* linear, std::size_t count, std::uint8_t* codes) {
    const RoundingTable& table = roundingTable();
    for (std::size_t i = 0; i < count; ++i)
        codes[i] = table.code(linear[i]);
}

} // namespace ibl
