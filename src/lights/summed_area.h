// A summed-area table of a lat-long probe's luminous energy, exact under subtraction.
#pragma once

#include "image/image.h"

#include <cstdint>
#include <vector>

namespace ibl {

/// A rectangle of lat-long pixels: columns [x, x + width), wrapping at the image's width, and rows
/// [y, y + height).
struct PixelRegion {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

/// The probe's luminance times solid angle over the sphere, negative luminances as 0.
double litEnergy(const Image& latlong, int threads);

/// Sums of luminance times solid angle over rectangles (Crow 1984).
///
/// Energies are held as 64-bit integers in units of 2^-62 of the probe's total. A rectangle's sum
/// is a difference of table entries: in floating point a dim rectangle beside a sun of 1e9 would
/// be what rounding left of the sun, in integers it is the exact sum of its pixels' energies, each
/// rounded to 2e-19 of the total. Integer sums do not depend on their order either.
class SummedAreaTable {
public:
    /// `latlong` has three channels and finite pixels. Negative luminances count as 0. Takes
    /// 8 bytes a pixel.
    SummedAreaTable(const Image& latlong, int threads);

    int width() const { return width_; }
    int height() const { return height_; }

    /// Luminance times solid angle over the region, in table units; from 0 to about 2^62.
    std::int64_t energy(const PixelRegion& region) const;

    /// Table units for one unit of luminance times steradian; 0 when the probe is black.
    double unitsPerEnergy() const { return scale_; }

private:
    std::int64_t corner(int x, int y) const {
        return sums_[static_cast<std::size_t>(y) * (static_cast<std::size_t>(width_) + 1) +
                     static_cast<std::size_t>(x)];
    }

    int width_;
    int height_;
    double scale_ = 0;
    std::vector<std::int64_t, UninitialisedAllocator<std::int64_t>> sums_; ///< (height+1)(width+1)
};

} // namespace ibl
