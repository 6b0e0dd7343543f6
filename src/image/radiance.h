// Radiance pictures (.hdr, .pic): Greg Ward, "Real Pixels", Graphics Gems II, 1991; the file format
// is that of Radiance's ray/src/common/color.c and resolu.c.
//
// A pixel is four bytes: mantissas of R, G and B and a common exponent e,
//     value = mantissa * 2^(e - 136),  e = 0 is black.
// Radiance's own reader adds a half to the mantissa, since its writer truncates; but most writers
// round, this one included, and for those that would make every value too bright.
#pragma once

#include "image/image.h"
#include "image/output_set.h"
#include "image/read.h"
#include "image/write.h"

#include <cstdint>
#include <span>
#include <string>

namespace ibl {

/// Decodes a Radiance picture of any of the eight orientations, flat or run-length coded in the old
/// or the new way. Values are divided by the product of the EXPOSURE lines and by that of the
/// COLORCORR lines. XYZ colours are refused. `name` is for messages. Throws inputError.
ImageFile readRadiance(std::span<const std::uint8_t> bytes, const std::string& name, int threads);

/// Encodes RGB (of RGBA, too: alpha is left out) floats, top row first, run-length coded where the
/// width allows (8 to 32767). Mantissas round to nearest. Black below 2^-128; above 255 * 2^119
/// clamped and counted; negatives and NaN become 0 and are counted.
WriteLosses writeRadiance(OutputFile& file, const Image& image, int threads);

} // namespace ibl
