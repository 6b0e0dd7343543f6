// Summed-area tables of a lat-long probe's luminous energy and its first moments.
#pragma once

#include "image/image.h"
#include "lights/pixel_blocks.h"
#include "lights/prefix_table.h"

#include <cstdint>

namespace ibl {

/// Sums over rectangles of luminance times solid angle and of luminance times the integral of the
/// direction, held as integers like `SummedAreaTable`'s and for the same reason. Negative
/// luminances count by their magnitude: a codec's ringing beside a sun can hold as much as the sky,
/// and where it is not weighed it is never cut apart from the light around it.
class MomentTable {
public:
    /// Energy, then the moments x, y, z, in units of 2^-62 of the probe's energy.
    struct Sums {
        std::int64_t parts[4];
    };

    /// Of blocks of 2^shift x 2^shift pixels, the last ones smaller; takes 96 bytes a block.
    MomentTable(const Image& latlong, int shift, int threads);

    /// In blocks, as all regions here.
    int width() const { return table_.width(); }
    int height() const { return table_.height(); }

    /// A region of blocks as one of pixels.
    PixelRegion pixels(const PixelRegion& region) const { return blocks_.pixels(region); }

    std::int64_t energy(const PixelRegion& region) const { return table_.sum(region).parts[0]; }

    /// Sum of luminance times squared distance from the region's centroid, in table units:
    /// W - |M|^2 / W, with W the energy and M the moment, since directions have length 1.
    double variance(const PixelRegion& region) const;

    /// Root mean square over the channels of |M_c - M E_c / W|, in table units: what they are
    /// displaced, times their energies E_c, by a light at the centroid of luminance.
    double colourDisplacement(const PixelRegion& region) const;

private:
    PixelBlocks blocks_;
    PrefixTable<Sums> table_;      ///< of luminance
    PrefixTable<Sums> red_, blue_; ///< their parts in it, in units of 2^-62 of their own energies
    double red_unit_ = 0, blue_unit_ = 0; ///< in units of table_
};

inline MomentTable::Sums operator+(const MomentTable::Sums& a, const MomentTable::Sums& b) {
    return {a.parts[0] + b.parts[0], a.parts[1] + b.parts[1], a.parts[2] + b.parts[2],
            a.parts[3] + b.parts[3]};
}

inline MomentTable::Sums operator-(const MomentTable::Sums& a, const MomentTable::Sums& b) {
    return {a.parts[0] - b.parts[0], a.parts[1] - b.parts[1], a.parts[2] - b.parts[2],
            a.parts[3] - b.parts[3]};
}

} // namespace ibl
