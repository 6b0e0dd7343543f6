// PNG, for pictures to look at: 8 bits a channel, sRGB.
#pragma once

#include "image/image.h"
#include "image/output_set.h"
#include "image/read.h"
#include "image/write.h"

#include <cstdint>
#include <span>
#include <string>

namespace ibl {

/// Writes bytes that are sRGB-encoded already, `channels` (3: RGB, 4: RGB and alpha) a pixel, row 0
/// at the top. PNG's alpha is not premultiplied, so neither are the colours here.
/// bytes.size() == width * height * channels. `threads` as everywhere.
void writePng8(OutputFile& file, std::span<const std::uint8_t> bytes, int width, int height,
               int channels, int threads = 0);

/// Writes scene-linear floats, encoded to sRGB and rounded; premultiplied alpha is divided out.
WriteLosses writePng(OutputFile& file, const Image& image, int threads = 0);

/// Decodes a PNG of any type, 8 or 16 bits: colours from sRGB to linear, alpha premultiplied.
/// `name` is for messages.
ImageFile readPng(std::span<const std::uint8_t> bytes, const std::string& name,
                  const ReadOptions& options);

} // namespace ibl
