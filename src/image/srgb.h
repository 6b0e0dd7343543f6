// The sRGB transfer function (IEC 61966-2-1), both ways.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ibl {

/// Linear light of an encoded value, 0..1 to 0..1.
float srgbToLinear(float encoded);
/// Encoded value of linear light, 0..1 to 0..1.
double linearToSrgb(double linear);
/// linearToSrgb in 255ths, rounded to nearest; below 0 and NaN give 0, above 1 gives 255.
std::uint8_t linearToSrgb8(float linear);
/// The same for `count` values.
void linearToSrgb8(const float* linear, std::size_t count, std::uint8_t* codes);

} // namespace ibl
