#include "convolve/near_own_texels.h"

#include "convolve/near_groups.h"
#include "convolve/near_texel.h"
#include "convolve/peaks.h"
#include "convolve/symmetries.h"
#include "core/parallel.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace ibl {
namespace {

/// What a pixel of the probe's image is.
enum class Pixel : char {
    none,  ///< it has no direction, or is another one's double
    plain, ///< a square in the image whose sides are smooth and are its neighbours' too
    cut,   ///< by the rim of a ball map, at a border or across a kink
};

/// Pixels next to one another on one face.
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
    std::vector<FourPoints> points; ///< of plain pixels
    std::vector<Tile> tiles;

    std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * map.width + x; }
    Pixel kindOf(int x, int y) const { return kind[at(x, y)]; }
    double solidAngle(int x, int y) const {
        const int i = std::min(x, map.width - 1 - x), j = y % rows;
        return quarter[at(i, std::min(j, rows - 1 - j))];
    }
    /// Its middle, about.
    V3d middle(int x, int y) const {
        if (kindOf(x, y) == Pixel::cut) return place(x, y, 0, 0);
        const std::array<Imath::V3f, 4>& four = points[at(x, y)].at;
        return V3d((four[0] + four[1] + four[2] + four[3]) * 0.25F);
    }
    /// Polar direction of a place in pixel (x, y), off its centre.
    V3d place(int x, int y, double right, double down) const {
        return texelPlace(map, x, y, V2d(right, down));
    }
};

/// Whether the rim is nowhere near pixel (x, y) of an n x n ball map: neither it nor one of its
/// neighbours is cut.
bool isWithinDisc(int n, int x, int y) {
    return std::hypot(std::abs(2 * x + 1 - n) + 3, std::abs(2 * y + 1 - n) + 3) < n;
}

/// Whether no edge of the octahedron crosses pixel (x, y).
bool isWithinFace(int n, int x, int y) {
    const int left = 2 * x - n, right = left + 2, top = 2 * y - n, bottom = top + 2;
    const int outer = std::max(-left, right) + std::max(-top, bottom);
    const int inner =
        std::min(std::abs(left), std::abs(right)) + std::min(std::abs(top), std::abs(bottom));
    return left * right >= 0 && top * bottom >= 0 && (outer <= n || inner >= n);
}

Pixel kindOf(const MapExtent& map, int rows, int x, int y) {
    if (!texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5)) return Pixel::none;
    const bool in_rows = y % rows > 0 && y % rows < rows - 1;
    switch (map.layout) {
    case Layout::angular:
    case Layout::mirrorBall:
        return isWithinDisc(map.width, x, y) ? Pixel::plain : Pixel::cut;
    case Layout::octahedral:
        return isWithinFace(map.width, x, y) ? Pixel::plain : Pixel::cut;
    case Layout::exrLatlong:
        if (x == map.width - 1) return Pixel::none; // the first once more
        return in_rows ? Pixel::plain : Pixel::cut;
    case Layout::exrCube:
        return in_rows && x > 0 && x < map.width - 1 ? Pixel::plain : Pixel::cut;
    default:
        return Pixel::plain;
    }
}

/// By Gauss's rule in the image.
FourPoints fourPoints(const Texels& texels, int x, int y) {
    constexpr double kOff = 0.5 / std::numbers::sqrt3;
    std::array<double, 4> share;
    FourPoints points;
    double total = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const V3d d = texels.place(x, y, k & 1 ? kOff : -kOff, k & 2 ? kOff : -kOff);
        points.at[k] = Imath::V3f(d);
        share[k] = solidAngleDensity(texels.map.layout, unpolar(d));
        total += share[k];
    }
    for (std::size_t k = 0; k < 4; ++k)
        points.share[k] = static_cast<float>(share[k] / total);
    return points;
}

constexpr int kTile = 16;

/// Sets a tile's bounds, if it has pixels.
bool measure(const Texels& texels, Tile& tile) {
    const auto isAtBorder = [&](int i, int j) {
        return i == 0 || j == 0 || i == tile.size.x - 1 || j == tile.size.y - 1;
    };
    std::vector<V3d> corners;
    V3d sum(0);
    tile.extent = 0;
    for (int j = 0; j < tile.size.y; ++j) {
        for (int i = 0; i < tile.size.x; ++i) {
            const int x = tile.first.x + i, y = tile.first.y + j;
            const Pixel kind = texels.kindOf(x, y);
            if (kind == Pixel::none) continue;
            if (kind == Pixel::plain && !isAtBorder(i, j)) {
                // A tile may be more than half the sphere, and its largest pixels within.
                tile.extent = std::max(tile.extent, texels.points[texels.at(x, y)].side());
                corners.push_back(texels.middle(x, y));
                continue;
            }
            const auto [low, high] =
                ownPart(texels.map.layout, texels.map.width, texels.map.height, x, y);
            const std::array<V3d, 4> of_pixel{
                texels.place(x, y, low.x, low.y), texels.place(x, y, high.x, low.y),
                texels.place(x, y, high.x, high.y), texels.place(x, y, low.x, high.y)};
            for (std::size_t k = 0; k < 4; ++k) {
                tile.extent = std::max(tile.extent, (of_pixel[k] - of_pixel[(k + 1) % 4]).length());
                corners.push_back(of_pixel[k]);
            }
        }
    }
    if (corners.empty()) return false;
    for (const V3d& corner : corners)
        sum += corner;
    tile.centre = sum.length() > 1e-3 ? sum.normalized() : corners[0];
    tile.radius = 0;
    for (const V3d& corner : corners)
        tile.radius = std::max(tile.radius, (corner - tile.centre).length());
    return true;
}

Texels texelsOf(const Panorama& probe, int threads) {
    Texels texels;
    if (isCubeFamily(probe.layout)) {
        const int edge = layoutSize(probe.layout, probe.image.width, probe.image.height).value();
        texels.probe = resample(probe, Layout::faces, edge, threads, Enlarging::hold);
    } else {
        texels.probe = probe;
        mergeBorder(texels.probe);
    }
    const int width = texels.probe.image.width, height = texels.probe.image.height;
    texels.map = {texels.probe.layout, width, height, 0};
    const bool faces = texels.map.layout == Layout::faces || texels.map.layout == Layout::exrCube;
    texels.rows = faces ? width : height;
    const auto inRows = [&](int rows, const auto& body) {
        parallelFor(static_cast<std::size_t>(rows), threads,
                    [&](std::size_t row) { body(static_cast<int>(row)); });
    };
    texels.kind.resize(texels.at(0, height));
    inRows(height, [&](int y) {
        for (int x = 0; x < width; ++x)
            texels.kind[texels.at(x, y)] = kindOf(texels.map, texels.rows, x, y);
    });
    texels.points.resize(texels.kind.size());
    inRows(height, [&](int y) {
        for (int x = 0; x < width; ++x)
            if (texels.kindOf(x, y) == Pixel::plain)
                texels.points[texels.at(x, y)] = fourPoints(texels, x, y);
    });
    texels.quarter.resize(texels.at(0, (texels.rows + 1) / 2));
    inRows((texels.rows + 1) / 2, [&](int y) {
        for (int x = 0; 2 * x < width; ++x)
            texels.quarter[texels.at(x, y)] =
                partSolidAngle(texels.map.layout, width, height, x, y);
    });
    std::vector<Tile> tiles;
    for (int face = 0; face < height / texels.rows; ++face) {
        const int i = (width - 1) / 2, j = face * texels.rows + (texels.rows - 1) / 2;
        const V3d middle = texels.place(i, j, 0, 0);
        const V3d right = texels.place(i, j, 0.25, 0) - middle;
        const V3d down = texels.place(i, j, 0, 0.25) - middle;
        texels.turn.push_back(right.cross(down).dot(middle) < 0 ? -1 : 1);
        for (int y = 0; y < texels.rows; y += kTile)
            for (int x = 0; x < width; x += kTile)
                tiles.push_back({face,
                                 {x, face * texels.rows + y},
                                 {std::min(kTile, width - x), std::min(kTile, texels.rows - y)},
                                 V3d(0),
                                 0,
                                 0});
    }
    std::vector<char> has_pixels(tiles.size());
    parallelFor(tiles.size(), threads,
                [&](std::size_t i) { has_pixels[i] = measure(texels, tiles[i]); });
    for (std::size_t i = 0; i < tiles.size(); ++i)
        if (has_pixels[i]) texels.tiles.push_back(tiles[i]);
    return texels;
}

/// A tile's weights in a map's texel.
struct Block {
    const Tile* tile;
    std::vector<double> weight; ///< [row][column]
    std::vector<char> near;     ///< which are by edges

    int at(int i, int j) const {
        const bool inside = i >= 0 && j >= 0 && i < tile->size.x && j < tile->size.y;
        return inside ? j * tile->size.x + i : -1;
    }
    bool isNear(int pixel) const { return pixel >= 0 && near[static_cast<std::size_t>(pixel)]; }
    void add(int pixel, double value) {
        if (isNear(pixel)) weight[static_cast<std::size_t>(pixel)] += value;
    }
};

/// The mean of the kernel over a pixel and the points of the map's texel: by 2 x 2 points.
double meanOf(const RadialTable& value, const Texels& texels, int x, int y,
              const std::vector<TexelPoint>& texel) {
    double mean = 0;
    const auto add = [&](const V3d& d, double share) {
        for (const TexelPoint& point : texel)
            mean += share * point.share * value((d - point.at).length2());
    };
    if (texels.kindOf(x, y) == Pixel::cut) {
        for (const TexelPoint& point : pointsOf(texels.map, x, y, {1, 2}))
            add(point.at, point.share);
    } else {
        const FourPoints& points = texels.points[texels.at(x, y)];
        for (std::size_t k = 0; k < 4; ++k)
            add(V3d(points.at[k]), points.share[k]);
    }
    return mean;
}

/// Marks the pixels that are near and sets the others' weights, as near_weights.cpp does.
void addFar(const NearField& field, const Texels& texels, const Texel& texel, Block& block) {
    const Tile& tile = *block.tile;
    const auto square = [](double a) { return a * a; };
    const double reach = field.kernel.reach + texel.radius + tile.extent;
    for (int j = 0; j < tile.size.y; ++j) {
        for (int i = 0; i < tile.size.x; ++i) {
            const int x = tile.first.x + i, y = tile.first.y + j;
            if (texels.kindOf(x, y) == Pixel::none) continue;
            const auto at = static_cast<std::size_t>(block.at(i, j));
            const double extent = texels.kindOf(x, y) == Pixel::cut
                                      ? tile.extent
                                      : texels.points[texels.at(x, y)].side();
            const double far2 =
                square(field.rules.far) * (square(1.4 * texel.radius) + square(extent));
            const double distance2 = (texels.middle(x, y) - texel.centre).length2();
            if (distance2 < far2) {
                block.near[at] = 1;
            } else if (distance2 <= square(reach)) {
                block.weight[at] =
                    texels.solidAngle(x, y) * meanOf(field.value, texels, x, y, texel.four);
            }
        }
    }
}

/// Adds what all edges of the near pixels carry.
void addNear(const Flow& flow, const Texels& texels, Block& block) {
    const Tile& tile = *block.tile;
    const V2i& first = tile.first;
    const auto isPlain = [&](int pixel) {
        return block.isNear(pixel) && texels.kindOf(first.x + pixel % tile.size.x,
                                                    first.y + pixel / tile.size.x) == Pixel::plain;
    };
    // Of each side of a plain pixel, from its corner `begin` to `end`; `other` lies beyond.
    const auto carry = [&](int pixel, int other, const V2d& begin, const V2d& end) {
        std::vector<Arc> arcs;
        const int x = first.x + pixel % tile.size.x, y = first.y + pixel / tile.size.x;
        addCurve(
            [&](double t) {
                const V2d off = begin + (end - begin) * t;
                return texels.place(x, y, off.x, off.y);
            },
            0, 1, 1, kLongest, arcs);
        double carried = 0;
        for (const Arc& arc : arcs)
            carried += flow.across(arc);
        block.add(pixel, carried);
        if (isPlain(other)) block.add(other, -carried);
    };
    for (int j = 0; j < tile.size.y; ++j) {
        for (int i = 0; i < tile.size.x; ++i) {
            const int pixel = block.at(i, j);
            if (!block.isNear(pixel)) continue;
            if (!isPlain(pixel)) {
                for (const Arc& arc : texelOf(texels.map, first.x + i, first.y + j, 1).outline)
                    block.add(pixel, flow.across(arc));
                continue;
            }
            // Around it, as outlines run; sides that it shares are those of what is to the right
            // and below.
            const int above = block.at(i, j - 1), left = block.at(i - 1, j);
            if (!isPlain(above)) carry(pixel, -1, {-0.5, -0.5}, {0.5, -0.5});
            carry(pixel, block.at(i + 1, j), {0.5, -0.5}, {0.5, 0.5});
            carry(pixel, block.at(i, j + 1), {0.5, 0.5}, {-0.5, 0.5});
            if (!isPlain(left)) carry(pixel, -1, {-0.5, 0.5}, {-0.5, -0.5});
        }
    }
    const double turn = texels.turn[static_cast<std::size_t>(tile.face)];
    for (std::size_t k = 0; k < block.weight.size(); ++k)
        if (block.near[k]) block.weight[k] *= turn;
}

/// A texel is area * (its area-filtered value) + sum of weight * pixel.
struct OwnWeights {
    double area = 0;
    std::vector<Block> blocks;
};

OwnWeights weightsOf(const NearField& field, const Texels& texels, const MapExtent& map, int x,
                     int y, const Footprint& of_map) {
    OwnWeights weights;
    const Footprint footprint = footprintOfTexel(of_map, map.layout, map.width, x, y);
    const Texel texel = texelOf(map, x, y, footprint.scale);
    if (texel.outline.empty()) { // the whole sphere in one texel
        weights.area = field.kernel.mass;
        return weights;
    }
    const bool leaves_area = footprint.scale == 1;
    const Flow flow(field, map, x, y, footprint, texel,
                    leaves_area ? Potential::withoutArea : Potential::withArea);
    double sum = 0;
    for (const Tile& tile : texels.tiles) {
        if ((tile.centre - texel.centre).length() >
            field.kernel.reach + texel.radius + tile.radius + tile.extent)
            continue;
        const auto count = static_cast<std::size_t>(tile.size.x) * tile.size.y;
        weights.blocks.push_back({&tile, std::vector<double>(count), std::vector<char>(count)});
        Block& block = weights.blocks.back();
        addFar(field, texels, texel, block);
        addNear(flow, texels, block);
        for (int j = 0; j < tile.size.y && !leaves_area; ++j)
            for (int i = 0; i < tile.size.x; ++i)
                block.add(block.at(i, j),
                          field.kernel.mass / (4 * kPi) *
                              texels.solidAngle(tile.first.x + i, tile.first.y + j));
        for (const double w : block.weight)
            sum += w;
    }
    // Between what is near and what is far the sums are of two kinds.
    if (leaves_area) {
        weights.area = field.kernel.mass - sum;
    } else {
        for (Block& block : weights.blocks)
            for (double& w : block.weight)
                w *= field.kernel.mass / sum;
    }
    return weights;
}

/// Where a symmetry's inverse takes a face's pixels: pixel (i, j) to origin + i right + j down, in
/// values of the image.
struct Moved {
    std::ptrdiff_t origin, right, down;
};

Moved movedBy(const Texels& texels, const Symmetry& symmetry, int face) {
    const MapExtent& map = texels.map;
    const auto from = [&](int i, int j) {
        const V3d d = *texelDirection(map.layout, map.width, map.height, i + 0.5,
                                      face * texels.rows + j + 0.5);
        const V2d p = texelPoint(map.layout, map.width, map.height, symmetry.back(d));
        return std::ptrdiff_t{3} *
               static_cast<std::ptrdiff_t>(texels.at(static_cast<int>(p.x), static_cast<int>(p.y)));
    };
    // From the middle, where a place has one pixel.
    const int i = (map.width - 1) / 2, j = (texels.rows - 1) / 2;
    const std::ptrdiff_t middle = from(i, j);
    const std::ptrdiff_t right = map.width > 1 ? from(i + 1, j) - middle : 0;
    const std::ptrdiff_t down = texels.rows > 1 ? from(i, j + 1) - middle : 0;
    return {middle - i * right - j * down, right, down};
}

/// The weighted sum for a texel that a symmetry takes to the one of the weights; `moved` of each
/// face by it.
V3d weightedSum(const Texels& texels, const OwnWeights& weights, const std::vector<Moved>& moved,
                const float* area) {
    V3d sum(weights.area * area[0], weights.area * area[1], weights.area * area[2]);
    for (const Block& block : weights.blocks) {
        const Tile& tile = *block.tile;
        const Moved& by = moved[static_cast<std::size_t>(tile.face)];
        const double* weight = block.weight.data();
        for (int j = 0; j < tile.size.y; ++j) {
            const int row = tile.first.y - tile.face * texels.rows + j;
            const float* pixel = texels.probe.image.pixels.data() + by.origin + row * by.down +
                                 tile.first.x * by.right;
            for (int i = 0; i < tile.size.x; ++i, pixel += by.right, ++weight) {
                for (int c = 0; c < 3; ++c)
                    sum[c] += *weight * pixel[c];
            }
        }
    }
    return sum;
}

} // namespace

bool seesOwnTexels(const Panorama& probe, const Lobe& lobe) {
    constexpr double kWidest = 0.03, kTexels = 8;
    if (probe.layout == Layout::latlong || lobe.kernel == Kernel::charlie) return false;
    const int size = layoutSize(probe.layout, probe.image.width, probe.image.height).value();
    // Beside borders fewer would leave no middle.
    constexpr int kLeastWithBorder = 5;
    const bool border = probe.layout == Layout::exrLatlong || probe.layout == Layout::exrCube;
    if (border && size < kLeastWithBorder) return false;
    return lobeWidth(lobe) < std::min(kWidest, kTexels * texelAngle({lobe, probe.layout, size}));
}

Image nearMapOfOwnTexels(const Panorama& probe, const NearField& field,
                         const PrefilterRequest& request, const Footprint& footprint, int threads,
                         Progress* progress) {
    if (isCubeFamily(request.layout) && request.layout != Layout::faces) {
        PrefilterRequest faces = request;
        faces.layout = Layout::faces;
        return resample({Layout::faces,
                         nearMapOfOwnTexels(probe, field, faces, footprint, threads, progress)},
                        request.layout, request.size, threads)
            .image;
    }
    const Texels texels = texelsOf(probe, threads);
    const V2i size = layoutExtent(request.layout, request.size);
    const MapExtent map{request.layout, size.x, size.y, texelAngle(request)};
    const Image area =
        resample(probe, request.layout, request.size, threads, Enlarging::hold).image;
    const std::vector<Symmetry> symmetries = symmetriesOf(probe.layout);
    std::vector<std::vector<Moved>> moved; // [symmetry][face]
    for (const Symmetry& symmetry : symmetries) {
        moved.emplace_back();
        for (int face = 0; face < texels.map.height / texels.rows; ++face)
            moved.back().push_back(movedBy(texels, symmetry, face));
    }
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * size.x + x; };
    std::vector<Shared> shared(at(0, size.y));
    parallelFor(static_cast<std::size_t>(size.y), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < size.x; ++x) {
            if (texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5))
                shared[at(x, y)] = sharedOf(map, symmetries, x, y);
        }
    });
    std::vector<KeyedTexel> keyed;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (shared[at(x, y)].key >= 0) keyed.push_back({shared[at(x, y)].key, x, y});
    return sumByKeys(
        request.layout, size, std::move(keyed), threads, progress,
        [&](int x, int y) { return weightsOf(field, texels, map, x, y, footprint); },
        [&](const OwnWeights& weights, int x, int y) {
            const auto symmetry = static_cast<std::size_t>(shared[at(x, y)].symmetry);
            return weightedSum(texels, weights, moved[symmetry], area.at(x, y));
        });
}

} // namespace ibl
