// Summed-area tables of a lat-long probe's luminous energy and its first moments.
#pragma once

#include "image/image.h"
#include "lights/summed_area.h"

#include <array>
#include <cstdint>
#include <vector>

namespace ibl {

/// Sums over rectangles of luminance times solid angle and of luminance times the integral of the
/// direction, held as integers like `SummedAreaTable`'s and for the same reason.
class MomentTable {
public:
    /// Energy, then the moments x, y, z, in units of 2^-62 of the probe's energy.
    using Sums = std::array<std::int64_t, 4>;

    /// As SummedAreaTable; takes 32 bytes a pixel.
    MomentTable(const Image& latlong, int threads);

    int width() const { return width_; }
    int height() const { return height_; }

    Sums sums(const PixelRegion& region) const;
    std::int64_t energy(const PixelRegion& region) const { return sums(region)[0]; }

    /// Sum of luminance times squared distance from the region's centroid, in table units:
    /// W - |M|^2 / W, with W the energy and M the moment, since directions have length 1.
    double variance(const PixelRegion& region) const;

private:
    const Sums& corner(int x, int y) const {
        return sums_[static_cast<std::size_t>(y) * (static_cast<std::size_t>(width_) + 1) +
                     static_cast<std::size_t>(x)];
    }

    int width_;
    int height_;
    std::vector<Sums, UninitialisedAllocator<Sums>> sums_; ///< (height + 1)(width + 1)
};

} // namespace ibl
