// A summed-area table of a lat-long probe's luminous energy, exact under subtraction.
#pragma once

#include "image/image.h"
#include "lights/pixel_blocks.h"
#include "lights/prefix_table.h"

#include <cstdint>

namespace ibl {

/// Sums of luminance times solid angle over rectangles.
///
/// Energies are held as 64-bit integers in units of 2^-62 of the probe's total. A rectangle's sum
/// is a difference of table entries: in floating point a dim rectangle beside a sun of 1e9 would
/// be what rounding left of the sun, in integers it is the exact sum of its blocks' energies, each
/// rounded to 2e-19 of the total. Integer sums do not depend on their order either.
class SummedAreaTable {
public:
    /// `latlong` has three channels and finite pixels. Negative luminances count as 0. Of blocks of
    /// 2^shift x 2^shift pixels, shift 0 or 1; takes 8 bytes a block.
    SummedAreaTable(const Image& latlong, int shift, int threads);

    /// In blocks, as all regions here.
    int width() const { return table_.width(); }
    int height() const { return table_.height(); }

    /// A region of blocks as one of pixels.
    PixelRegion pixels(const PixelRegion& region) const { return blocks_.pixels(region); }

    /// Luminance times solid angle over the region, in table units; from 0 to about 2^62.
    std::int64_t energy(const PixelRegion& region) const { return table_.sum(region); }

    /// Table units for one unit of luminance times steradian; 0 when the probe is black.
    double unitsPerEnergy() const { return scale_; }

private:
    PixelBlocks blocks_;
    PrefixTable<std::int64_t> table_;
    double scale_ = 0;
};

} // namespace ibl
