// The pixels of a probe of another layout than lat-long, as kernels meet them.
#pragma once

#include "convolve/texels.h"
#include "panorama/panorama.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace ibl {

/// What a pixel of the probe's image is.
enum class Pixel : char {
    none,  ///< it has no direction, or is another one's double
    plain, ///< a square in the image whose sides are smooth and are its neighbours' too
    cut,   ///< by the rim of a ball map, at a border or across a kink
};

/// Pixels next to one another on one face, and what bounds them.
struct Tile {
    int face;
    V2i first, size;
    V3d centre;
    double radius; ///< of the farthest corner, chord
    double extent; ///< of a pixel's longest side, chord
};

/// Four points of a pixel and their shares in it. Single precision: what it is for is far from them
/// beside the pixel.
struct FourPoints {
    std::array<Imath::V3f, 4> at;
    std::array<float, 4> share;

    /// The pixel's longer side, about, chord.
    double side() const {
        const float square = std::max((at[1] - at[0]).length2(), (at[2] - at[0]).length2());
        return std::sqrt(3.0 * square);
    }
};

/// The probe.
struct Texels {
    Panorama probe; ///< its cube's faces stand one below the other
    MapExtent map;
    int rows; ///< of a face, or all
    std::vector<Pixel> kind;
    std::vector<double> quarter; ///< pixels' solid angles, of one quarter of a face
    std::vector<double> turn; ///< of each face: 1, or -1 where outlines run clockwise on the sphere
    std::vector<FourPoints> kept; ///< of plain pixels, unless there are too many to keep
    std::vector<Tile> tiles;

    std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * map.width + x; }
    Pixel kindOf(int x, int y) const { return kind[at(x, y)]; }
    double solidAngle(int x, int y) const {
        const int i = std::min(x, map.width - 1 - x), j = y % rows;
        return quarter[at(i, std::min(j, rows - 1 - j))];
    }
    /// The longer side of a pixel, about, chord; of one that is cut, of the tile's longest.
    double side(int x, int y, const Tile& tile) const {
        return kindOf(x, y) == Pixel::cut ? tile.extent : pointsOfPlain(x, y).side();
    }
    /// Its middle, about.
    V3d middle(int x, int y) const {
        if (kindOf(x, y) == Pixel::cut) return place(x, y, 0, 0);
        const FourPoints four = pointsOfPlain(x, y);
        return V3d((four.at[0] + four.at[1] + four.at[2] + four.at[3]) * 0.25F);
    }
    /// By Gauss's rule in the image.
    FourPoints pointsOfPlain(int x, int y) const {
        return kept.empty() ? makePoints(x, y) : kept[at(x, y)];
    }
    FourPoints makePoints(int x, int y) const;
    /// Polar direction of a place in pixel (x, y), off its centre.
    V3d place(int x, int y, double right, double down) const {
        return texelPlace(map, x, y, V2d(right, down));
    }
};

/// Of a probe of any layout but latlong.
Texels texelsOf(const Panorama& probe, int threads);

} // namespace ibl
