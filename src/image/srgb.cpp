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

/// Rounding without a power or a branch a pixel: the upper bits of a float choose a cell, 128 an
/// octave, which has room for no more than one step from a code to the next (the last octave has
/// 0.66 of them). Values below 2^-13 encode to less than half a code.
class RoundingTable {
public:
    RoundingTable() {
        std::array<float, 257> starts{}; // the least float that rounds to each code
        for (std::size_t c = 1; c < 256; ++c) {
            const double exact = decode((static_cast<double>(c) - 0.5) / 255);
            starts[c] = static_cast<float>(exact);
            if (starts[c] < exact) starts[c] = std::nextafter(starts[c], 2.0F);
        }
        starts[256] = 2;
        std::uint32_t code = 0;
        for (std::uint32_t b = kFirst; b < kEnd; ++b) {
            const float least = std::bit_cast<float>(b << kShift);
            while (least >= starts[code + 1])
                ++code;
            cells_[b - kFirst] = {starts[code + 1], code};
        }
    }

    std::uint8_t code(float linear) const {
        linear = linear > kLeast ? linear : kLeast; // so is NaN
        linear = linear < kMost ? linear : kMost;
        const Cell& cell = cells_[(std::bit_cast<std::uint32_t>(linear) >> kShift) - kFirst];
        return static_cast<std::uint8_t>(cell.code + (linear >= cell.step));
    }

private:
    static constexpr int kShift = 23 - 7;
    static constexpr float kLeast = 0x1p-13F, kMost = 0x1.fffffep-1F; // code 0 and code 255
    static constexpr std::uint32_t kFirst = std::bit_cast<std::uint32_t>(kLeast) >> kShift;
    static constexpr std::uint32_t kEnd = std::bit_cast<std::uint32_t>(1.0F) >> kShift;

    struct Cell {
        float step;         ///< from which the code is one more
        std::uint32_t code; ///< of the cell's least float
    };
    std::array<Cell, kEnd - kFirst> cells_{};
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
