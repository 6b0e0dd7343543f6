// A picture of the probe with its lights on it.
#pragma once

#include "image/image.h"
#include "lights/light.h"

#include <cstdint>
#include <vector>

namespace ibl {

/// 8-bit sRGB, three bytes a pixel, row 0 at the top.
struct Preview {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bytes;
};

/// The lat-long probe, a mean luminance (by its logarithm) of 0.18 and highlights compressed by
/// L / (1 + L) (Reinhard 2002), at a whole fraction or multiple of its size near 1024 wide; over it
/// the borders of the lights' regions and a dot at each light, a lamp's circle in place of borders.
Preview drawPreview(const Image& latlong, const std::vector<Light>& lights);

} // namespace ibl
