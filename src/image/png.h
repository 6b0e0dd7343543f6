// PNG, for pictures to look at: 8 or 16 bits a channel, sRGB.
#pragma once

#include "image/image.h"
#include "image/output_set.h"
#include "image/read.h"
#include "image/write.h"

#include <cstdint>
#include <span>
#include <string>

namespace ibl {

struct PngOptions {
    int bits = 8; ///< a channel: 8 or 16
    /// Adds a pattern of 16x16 thresholds (Bayer 1973) before rounding down, so that the mean over
    /// neighbours is right between two codes; the same pattern in every file.
    bool dither = false;
    bool encoded =
        false; ///< the values are encoded for a display already; otherwise they are linear
};

/// Writes scene-linear floats, encoded to sRGB and rounded to nearest, or encoded values as they
/// are; premultiplied alpha is divided out. `threads` as everywhere.
WriteLosses writePng(OutputFile& file, const Image& image, const PngOptions& options = {},
                     int threads = 0);

/// Decodes a PNG of any type, 8 or 16 bits: colours from sRGB to linear, alpha premultiplied.
/// `name` is for messages.
ImageFile readPng(std::span<const std::uint8_t> bytes, const std::string& name,
                  const ReadOptions& options);

} // namespace ibl
