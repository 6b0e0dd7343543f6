// A lat-long's pixels in square blocks, for tables that need not hold every pixel.
#pragma once

#include "image/image.h"
#include "lights/prefix_table.h"

#include <algorithm>

namespace ibl {

/// Blocks of 2^shift x 2^shift pixels, the last ones of rows and columns smaller.
struct PixelBlocks {
    int pixel_width;
    int pixel_height;
    int shift;

    int width() const { return ((pixel_width - 1) >> shift) + 1; }
    int height() const { return ((pixel_height - 1) >> shift) + 1; }

    /// A region of blocks as one of pixels.
    PixelRegion pixels(const PixelRegion& r) const {
        const int end = r.x + r.width;
        const int right = end <= width() ? std::min(pixel_width, end << shift)
                                         : pixel_width + ((end - width()) << shift);
        const int x = r.x << shift, y = r.y << shift;
        return {x, y, std::min(right - x, pixel_width),
                std::min(pixel_height, (r.y + r.height) << shift) - y};
    }
};

} // namespace ibl
